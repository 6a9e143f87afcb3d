// Breaks files as transfers, editors and enemies do. The same random numbers, the same file.
#pragma once
#include "runtime/core/random.h"
#include "tests/hostile/reader.h"

namespace coppice::hostile {

// One to four changes: bits, bytes and words replaced, pieces removed, repeated or moved; of texts and of JSON in binary
// files also numbers and names replaced. Of packed formats the checksums mostly fit again.
Bytes mutate(const Reader& reader, const Bytes& seed, Random& random);

}  // namespace coppice::hostile
