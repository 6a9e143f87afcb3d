// One editor at a time has a scene, from its opening to its end: a file NAME.lock beside it that only one program can hold. What a
// program that was killed left behind holds nobody out.
#pragma once
#include <string>
#include "runtime/core/result.h"

namespace coppice {

class SceneLock {
  public:
    // Where nothing can be written beside the scene it holds nothing: nobody can save there. Errors: write_failed, where another
    // editor has the scene.
    static Result<SceneLock> take(const std::string& scene_path);
    SceneLock() = default;
    SceneLock(SceneLock&& other) noexcept { *this = std::move(other); }
    SceneLock& operator=(SceneLock&& other) noexcept;
    ~SceneLock();

  private:
    std::string path_;
    int file_ = -1;
};

}  // namespace coppice
