#include "tools/coppice/bundle_folder.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <system_error>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include "runtime/core/file.h"
#include "runtime/core/mapped_file.h"

namespace coppice {
namespace {

namespace fs = std::filesystem;
constexpr const char* k_list = "bundle.json";
constexpr const char* k_format = "coppice bundle";

// Below the folder, whatever a list says that somebody may have edited.
bool is_inside(const fs::path& path) {
    return !path.empty() && path.is_relative() && path == path.lexically_normal() && path.has_filename() &&
           *path.begin() != ".." && path != ".";
}

Result<std::vector<std::string>> read_list(const std::string& folder) {
    const std::string file = folder + "/" + k_list;
    COPPICE_TRY(const std::string text, read_text_file(file));
    auto broken = [&] {
        return fail(ErrorId::usage, file, "", "is not the list of a bundle",
                    "name a new or empty folder, or a bundle");
    };
    const nlohmann::json list = nlohmann::json::parse(text, nullptr, false);
    if (!list.is_object() || list.value("format", nlohmann::json()) != k_format || !list.contains("files") ||
        !list["files"].is_array())
        return broken();
    std::vector<std::string> paths;
    for (const nlohmann::json& path : list["files"]) {
        if (!path.is_string() || !is_inside(path.get_ref<const std::string&>())) return broken();
        paths.push_back(path);
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

// For everyone who may read it.
Status make_executable(const std::string& path) {
    std::error_code error;
    const fs::perms mode = fs::status(path, error).permissions();
    fs::perms execute = fs::perms::none;
    if ((mode & fs::perms::owner_read) != fs::perms::none) execute |= fs::perms::owner_exec;
    if ((mode & fs::perms::group_read) != fs::perms::none) execute |= fs::perms::group_exec;
    if ((mode & fs::perms::others_read) != fs::perms::none) execute |= fs::perms::others_exec;
    if (!error) fs::permissions(path, execute, fs::perm_options::add, error);
    if (error)
        return fail(ErrorId::write_failed, path, "", "cannot be made executable: " + error.message(),
                    "name a folder on a file system that has permissions");
    return {};
}

}  // namespace

Result<BundleFolder> BundleFolder::open(const std::string& folder) {
    BundleFolder bundle;
    bundle.folder_ = folder;
    std::error_code error;
    if (!fs::exists(folder, error) && !error) return bundle;
    const bool empty = fs::is_directory(folder, error) && fs::is_empty(folder, error);
    if (error || (!empty && !fs::is_regular_file(folder + "/" + k_list, error)))
        return fail(ErrorId::usage, folder, "", "is neither an empty folder nor a bundle",
                    "name a new or empty folder, or a bundle, which is replaced");
    if (!empty) {
        COPPICE_TRY(bundle.old_paths_, read_list(folder));
    }
    return bundle;
}

Status BundleFolder::write_list(const std::vector<std::string>& paths) const {
    const nlohmann::json list{{"format", k_format}, {"files", paths}};
    const auto replace = nlohmann::json::error_handler_t::replace;
    return write_text_file(folder_ + "/" + k_list, list.dump(2, ' ', false, replace) + "\n");
}

Status BundleFolder::replace(std::span<const BundleFile> files) const {
    std::vector<std::string> paths, all, stale;
    for (const BundleFile& file : files) paths.push_back(file.path);
    std::sort(paths.begin(), paths.end());
    std::set_union(paths.begin(), paths.end(), old_paths_.begin(), old_paths_.end(), std::back_inserter(all));
    std::set_difference(old_paths_.begin(), old_paths_.end(), paths.begin(), paths.end(),
                        std::back_inserter(stale));
    COPPICE_CHECK(write_list(all));  // first, so that what an error leaves behind is known as ours
    for (const BundleFile& file : files) {
        const std::string path = folder_ + "/" + file.path;
        if (file.source.empty()) {
            COPPICE_CHECK(write_text_file(path, file.text));
        } else {
            COPPICE_TRY(const MappedFile source, MappedFile::open(file.source));
            COPPICE_CHECK(write_file(path, source.bytes()));
        }
        if (file.executable) COPPICE_CHECK(make_executable(path));
    }
    std::error_code ignored;  // a file that stays does no harm
    for (const std::string& path : stale) fs::remove(fs::path(folder_) / path, ignored);
    return write_list(paths);
}

Result<uint64_t> size_bytes(const BundleFile& file) {
    if (file.source.empty()) return file.text.size();
    COPPICE_TRY(const MappedFile source, MappedFile::open(file.source));
    return source.bytes().size();
}

}  // namespace coppice
