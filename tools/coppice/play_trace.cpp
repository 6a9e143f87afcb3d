#include "tools/coppice/play_trace.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace coppice {
namespace {

enum Row { k_cpu_row = 1, k_device_row = 2 };

class Trace {
  public:
    void name_row(Row row, const std::string& name) {
        add(fmt::format(R"({{"name":"thread_name","ph":"M","pid":1,"tid":{},"args":{{"name":{}}}}})",
                        int(row), quoted(name)));
    }
    // arguments: JSON object. Slices of no length are left out.
    void add_slice(Row row, const std::string& name, double start_ms, double length_ms,
                   const std::string& arguments = "{}") {
        if (length_ms > 0.0)
            add(fmt::format(R"({{"name":{},"ph":"X","pid":1,"tid":{},"ts":{:.1f},"dur":{:.1f},"args":{}}})",
                            quoted(name), int(row), start_ms * 1e3, length_ms * 1e3, arguments));
    }
    void add_counter(const std::string& name, double at_ms, uint64_t value) {
        add(fmt::format(R"({{"name":{},"ph":"C","pid":1,"ts":{:.1f},"args":{{"count":{}}}}})", quoted(name),
                        at_ms * 1e3, value));
    }
    std::string text() const {
        return "{\"displayTimeUnit\":\"ms\",\"traceEvents\":[\n" + events_ + "\n]}\n";
    }

  private:
    static std::string quoted(const std::string& name) {
        return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    }
    void add(const std::string& event) {
        if (!events_.empty()) events_ += ",\n";
        events_ += event;
    }
    std::string events_;
};

}  // namespace

std::string chrome_trace(const PlayRecord& record) {
    Trace trace;
    trace.name_row(k_cpu_row, "CPU");
    trace.name_row(k_device_row, record.device);
    for (const FrameRecord& frame : record.frames) {
        trace.add_slice(k_cpu_row, fmt::format("frame {}", frame.frame), frame.start_ms, frame.wall_ms,
                        fmt::format(R"({{"repeat":{},"vertices":{},"tiles":{}}})", frame.repeat,
                                    frame.report.vertices, frame.report.tiles_touched));
        double at_ms = frame.start_ms;
        const FrameReport& report = frame.report;
        for (const auto& [name, ms] :
             {std::pair("stream", report.stream_ms), std::pair("cull", report.cull_ms),
              std::pair("lod", report.lod_ms), std::pair("write", report.write_ms)}) {
            trace.add_slice(k_cpu_row, name, at_ms, ms);
            at_ms += ms;
        }
        at_ms = frame.start_ms + frame.cpu_ms;
        for (size_t pass = 0; pass < frame.pass_ms.size(); ++pass) {
            trace.add_slice(k_device_row, record.passes[pass], at_ms, frame.pass_ms[pass]);
            at_ms += frame.pass_ms[pass];
        }
        trace.add_counter("vertices", frame.start_ms, report.vertices);
        trace.add_counter("allocations", frame.start_ms, frame.allocations);
    }
    return trace.text();
}

}  // namespace coppice
