#include "tools/coppice/play_junit.h"

#include <algorithm>
#include <fmt/format.h>

namespace coppice {
namespace {

std::string escape_xml(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '"')
            escaped += "&quot;";
        else if (uint8_t(c) >= 0x20 || c == '\n' || c == '\t')
            escaped += c;
    }
    return escaped;
}

}  // namespace

std::string junit_xml(const PlayRecord& record) {
    const std::vector<Check>& checks = record.checks;
    auto count = [&](Verdict verdict) {
        return std::count_if(checks.begin(), checks.end(),
                             [=](const Check& check) { return check.verdict == verdict; });
    };
    double flown_ms = 0.0;
    for (const FrameRecord& frame : record.frames) flown_ms += frame.wall_ms;
    std::string xml = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n<testsuite name=\"coppice play {}\" "
        "tests=\"{}\" "
        "failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"{:.3f}\">\n",
        escape_xml(record.scene_name), checks.size(), count(Verdict::failed), count(Verdict::inconclusive),
        flown_ms * 1e-3);
    xml += fmt::format(
        "<properties><property name=\"device\" value=\"{}\"/><property name=\"driver\" value=\"{}\"/>"
        "<property name=\"processor\" value=\"{}\"/><property name=\"command\" value=\"{}\"/></properties>\n",
        escape_xml(record.device), escape_xml(record.driver), escape_xml(record.machine.processor),
        escape_xml(record.command));
    for (const Check& check : checks) {
        xml += fmt::format("<testcase classname=\"coppice.play\" name=\"{}\">", escape_xml(check.name));
        if (check.verdict == Verdict::failed)
            xml += fmt::format("<failure message=\"{}\"/>", escape_xml(check.fault));
        if (check.verdict == Verdict::inconclusive)
            xml += fmt::format("<skipped message=\"{}\"/>", escape_xml(check.fault));
        xml += "</testcase>\n";
    }
    return xml + "</testsuite>\n</testsuites>\n";
}

}  // namespace coppice
