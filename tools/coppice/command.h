// A subcommand: its options go into the program's command line, its work into `chosen` when the user names
// it.
#pragma once
#include <functional>
#include <CLI/CLI.hpp>
#include "runtime/core/result.h"

namespace coppice {

using Command = std::function<Status()>;

void add_cook(CLI::App& app, Command& chosen);
void add_inspect(CLI::App& app, Command& chosen);
void add_play(CLI::App& app, Command& chosen);
void add_populate(CLI::App& app, Command& chosen);
void add_bench(CLI::App& app, Command& chosen);
void add_compare(CLI::App& app, Command& chosen);
void add_bundle(CLI::App& app, Command& chosen);

}  // namespace coppice
