#include "editor/document/journal.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>
#include <fcntl.h>
#include <unistd.h>
#include <fmt/format.h>
#include "plugins/vegetation/eco/scene_file.h"
#include "runtime/core/file.h"
#include "runtime/core/hash.h"

namespace coppice {
namespace {

// A mark, then records: length, hash, bytes. The first is the base.
constexpr std::string_view k_mark = "coppice journal 1\n";
constexpr size_t k_head_bytes = 16;

void put_number(std::string& bytes, uint64_t value) {
    for (int i = 0; i < 8; ++i) bytes.push_back(char(uint8_t(value >> (8 * i))));
}
uint64_t number_at(std::string_view bytes, size_t at) {
    uint64_t value = 0;
    for (size_t i = 0; i < 8; ++i) value |= uint64_t(uint8_t(bytes[at + i])) << (8 * i);
    return value;
}

std::string record_of(std::string_view content) {
    std::string record;
    put_number(record, content.size());
    put_number(record, hash_text(content));
    return record + std::string(content);
}

// Takes the first record off; false: it is not whole.
bool take_record(std::string_view& bytes, std::string_view& content) {
    if (bytes.size() < k_head_bytes) return false;
    const uint64_t length = number_at(bytes, 0), hash = number_at(bytes, 8);
    if (length > bytes.size() - k_head_bytes) return false;
    content = bytes.substr(k_head_bytes, length);
    if (hash_text(content) != hash) return false;
    bytes.remove_prefix(k_head_bytes + length);
    return true;
}

std::string write_base(const std::vector<JournalBase>& base) {
    std::string text;
    for (const JournalBase& file : base) text += hash_to_hex(file.hash) + " " + file.path + "\n";
    return text;
}

std::vector<JournalBase> read_base(std::string_view text) {
    std::vector<JournalBase> base;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(line.size() + 1, text.size()));
        if (line.size() < 18) continue;
        base.push_back({std::string(line.substr(17)),
                        std::strtoull(std::string(line.substr(0, 16)).c_str(), nullptr, 16)});
    }
    return base;
}

bool write_all(int file, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(file, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return false;
        bytes.remove_prefix(size_t(count));
    }
    return true;
}

tl::unexpected<Error> failed(const std::string& path, const char* what, const char* remedy) {
    return fail(ErrorId::write_failed, path, "", std::string(what) + ": " + std::strerror(errno), remedy);
}

}  // namespace

std::string journal_path(const std::string& scene_path) { return scene_path + ".journal"; }

std::vector<JournalBase> journal_base(const Document& document) {
    std::vector<JournalBase> base;
    for (const auto& [path, file] : document.files()) {
        if (file.saved_text_hash) base.push_back({path, *file.saved_text_hash});
        if (!file.saved_text_hash && path == document.root_path()) base.push_back({path, k_no_file});
        if (file.saved_plants_hash) base.push_back({file.placed_path, *file.saved_plants_hash});
    }
    return base;
}

Result<JournalContent> Journal::read(const std::string& path) {
    COPPICE_TRY(const std::string bytes, read_text_file(path, size_t(1) << 34));
    std::string_view rest = bytes, content;
    if (!rest.starts_with(k_mark))
        return fail(ErrorId::format_unknown, path, "", "no journal", "delete it, if it is not needed");
    rest.remove_prefix(k_mark.size());
    if (!take_record(rest, content))
        return fail(ErrorId::format_unknown, path, "", "ends in its head", "delete it: it holds no edit");
    JournalContent journal;
    journal.base = read_base(content);
    while (take_record(rest, content)) journal.edits.emplace_back(content);
    journal.dropped_bytes = rest.size();
    journal.whole_bytes = bytes.size() - rest.size();
    return journal;
}

namespace {

constexpr const char* k_remedy =
    "work goes on, but would be lost with the program: free space, or save elsewhere";

// So that a name in it outlives the machine.
void sync_folder_of(const std::string& path) {
    const std::string folder = std::filesystem::path(path).parent_path().string();
    const int file = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file < 0) return;
    ::fsync(file);
    ::close(file);
}

}  // namespace

Result<Journal> Journal::create(const std::string& path, const std::vector<JournalBase>& base,
                                const std::vector<std::string>& edits) {
    const std::string beside = path + ".new";
    std::string bytes = std::string(k_mark) + record_of(write_base(base));
    for (const std::string& edit : edits) bytes += record_of(edit);
    Journal journal;
    journal.path_ = path;
    journal.file_ = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (journal.file_ < 0) return failed(path, "cannot open the journal", k_remedy);
    if (!write_all(journal.file_, bytes) || ::fdatasync(journal.file_) != 0 ||
        ::rename(beside.c_str(), path.c_str()) != 0) {
        auto result = failed(path, "cannot write the journal", k_remedy);
        ::unlink(beside.c_str());
        return result;
    }
    sync_folder_of(path);
    journal.size_bytes_ = int64_t(bytes.size());
    return journal;
}

Result<Journal> Journal::resume(const std::string& path, const JournalContent& content) {
    Journal journal;
    journal.path_ = path;
    journal.file_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    journal.size_bytes_ = int64_t(content.whole_bytes);
    if (journal.file_ < 0 || ::ftruncate(journal.file_, journal.size_bytes_) != 0 ||
        ::lseek(journal.file_, journal.size_bytes_, SEEK_SET) != journal.size_bytes_)
        return failed(path, "cannot go on with the journal", k_remedy);
    return journal;
}

Result<std::string> keep_old_journal(const std::string& path, bool stays) {
    for (int n = 1; n < 10000; ++n) {
        const std::string old = path + (n == 1 ? ".old" : fmt::format(".old.{}", n));
        // Of two that try at once one finds the name taken.
        if (::link(path.c_str(), old.c_str()) != 0) {
            if (errno == EEXIST) continue;
            // Where there are no links, a name that is free is all there is.
            std::error_code error;
            if (std::filesystem::exists(old, error)) continue;
            std::filesystem::copy_file(path, old, error);
            if (error) return failed(path, "cannot keep the journal", "free space, then open the scene again");
        }
        if (!stays) ::unlink(path.c_str());
        sync_folder_of(path);
        return old;
    }
    return fail(ErrorId::write_failed, path, "", "there are 10,000 old journals beside it", "delete some");
}

Status Journal::append(std::string_view edit) {
    const std::string record = record_of(edit);
    if (write_all(file_, record) && ::fdatasync(file_) == 0) {
        size_bytes_ += int64_t(record.size());
        return {};
    }
    auto result = failed(path_, "cannot write the journal",
                         "work goes on, but would be lost with the program: free space, or save elsewhere");
    if (::ftruncate(file_, size_bytes_) == 0) ::lseek(file_, size_bytes_, SEEK_SET);
    return result;
}

Journal::Journal(Journal&& other) noexcept { *this = std::move(other); }
Journal& Journal::operator=(Journal&& other) noexcept {
    std::swap(path_, other.path_);
    std::swap(file_, other.file_);
    std::swap(size_bytes_, other.size_bytes_);
    return *this;
}
Journal::~Journal() {
    if (file_ >= 0) ::close(file_);
}

}  // namespace coppice
