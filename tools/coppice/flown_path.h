// The path that was flown in a window, as keys a tenth of a second apart.
#pragma once
#include <string>
#include <vector>
#include "plugins/vegetation/eco/camera_path.h"
#include "runtime/core/file.h"

namespace coppice {

class FlownPath {
  public:
    // time_s: since the start; grows. What comes after k_key_limit keys, hours, is left out.
    void add(double time_s, const Camera& camera) {
        if (keys_.size() >= k_key_limit || (!keys_.empty() && time_s < keys_.back().time_s + k_step_s))
            return;
        keys_.push_back({time_s, camera});
    }
    // Errors: write_failed.
    Status write(const std::string& file) const { return write_text_file(file, camera_path_text(keys_)); }

  private:
    static constexpr double k_step_s = 0.1;
    std::vector<CameraKey> keys_;
};

}  // namespace coppice
