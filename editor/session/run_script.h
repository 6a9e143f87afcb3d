// Commands from a file, without a window: layouts made and tested by machines.
//   {"commands": [{"paint": {...}}, {"undo": {}}, {"expect": {"populations": ["oak"], "least": 10}}, {"save": {}}]}
#pragma once
#include "editor/session/session.h"

namespace coppice {

// In order, up to the first that fails; what was done before stays done, and is not saved. Beside the commands of
// commands/command.h: undo, redo, save, export_csv, export_gltf, expect. Errors: those of the commands, with their place in the
// script; regressed for what was expected and is not so.
Status run_script(Session& session, const std::string& script_path);

}  // namespace coppice
