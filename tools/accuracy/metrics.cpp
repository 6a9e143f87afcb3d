#include "tools/accuracy/metrics.h"

namespace coppice {}  // namespace coppice
