// What a playthrough is asked to keep, and whether it did: `coppice play --budget`, pictures against goldens, repeats
// against each other.
#pragma once
#include <string>
#include <vector>
#include "runtime/core/result.h"

namespace coppice {

enum class Verdict { passed, failed, inconclusive };
const char* name_of(Verdict verdict);

struct Check {
    std::string name;
    Verdict verdict;
    double value, limit;
    std::string unit;
    std::string fault;  // what went wrong, and what would be right; empty where it passed
};

// One of the names a budget may have; the list is budget_kinds().
struct BudgetKind {
    const char* name;
    const char* unit;  // of the value and the limit: "ms", "MiB", or a count's
    const char* what;  // one line, for --help
    bool is_time;      // its verdict needs a quiet machine
};
std::vector<BudgetKind> budget_kinds();

struct Budget {
    BudgetKind kind;
    double limit;  // in the kind's unit
};

// "frame=33ms,memory=512MiB,error=0.05". Times take ms, s or us; sizes MiB, GiB, KiB or B; the others a bare number.
// Errors: usage, name_unknown.
Result<std::vector<Budget>> parse_budgets(const std::string& text);

struct PlayRecord;

// Each budget is measured in every repeat. Of counts and sizes the worst repeat decides. A time passes where it keeps its
// limit in every repeat and fails where it does in none; in between, or where other programs had more than
// k_quiet_share of the machine while it failed, it is inconclusive. Also: every repeat drew the same.
inline constexpr double k_quiet_share = 0.1;
std::vector<Check> check_playthrough(const PlayRecord& record, const std::vector<Budget>& budgets);

// Passed, or the first fault. Errors: regressed where one failed, else inconclusive.
Status status_of(const std::vector<Check>& checks);

}  // namespace coppice
