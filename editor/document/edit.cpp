#include "editor/document/edit.h"

#include <algorithm>
#include <utility>

namespace coppice {
namespace {

// Lengths before contents, little-endian; plants in files of their own format, which names their kinds.
void put_number(std::string& bytes, uint64_t value) {
    for (int i = 0; i < 8; ++i) bytes.push_back(char(uint8_t(value >> (8 * i))));
}
void put_text(std::string& bytes, std::string_view text) {
    put_number(bytes, text.size());
    bytes += text;
}

class Reader {
  public:
    explicit Reader(std::string_view bytes) : rest_(bytes) {}
    uint64_t number() {
        uint64_t value = 0;
        if (rest_.size() < 8) {
            sound_ = false;
            rest_ = {};
            return 0;
        }
        for (int i = 0; i < 8; ++i) value |= uint64_t(uint8_t(rest_[size_t(i)])) << (8 * i);
        rest_.remove_prefix(8);
        return value;
    }
    std::string_view text() {
        const uint64_t length = number();
        if (length > rest_.size()) {
            sound_ = false;
            return {};
        }
        const std::string_view text = rest_.substr(0, length);
        rest_.remove_prefix(length);
        return text;
    }
    bool sound() const { return sound_; }
    bool done() const { return rest_.empty(); }

  private:
    std::string_view rest_;
    bool sound_ = true;
};

// A text that is not there is no text: every file has one byte at least.
void put_scene(std::string& bytes, const SceneTextPtr& scene) { put_text(bytes, scene ? scene->text : ""); }

}  // namespace

bool Edit::empty() const {
    return std::all_of(files.begin(), files.end(), [](const FileEdit& file) { return file.empty(); });
}

Edit inverse(Edit edit) {
    std::reverse(edit.files.begin(), edit.files.end());
    for (FileEdit& file : edit.files) {
        std::swap(file.before, file.after);
        std::swap(file.removed, file.added);
    }
    return edit;
}

std::string write_edit(const Edit& edit, const std::vector<std::string>& kinds) {
    std::string bytes;
    put_text(bytes, edit.name);
    put_number(bytes, edit.files.size());
    for (const FileEdit& file : edit.files) {
        put_text(bytes, file.path);
        put_number(bytes, file.before == file.after ? 0 : 1);
        if (file.before != file.after) {
            put_scene(bytes, file.before);
            put_scene(bytes, file.after);
        }
        for (const std::vector<PlacedPlant>* plants : {&file.removed, &file.added})
            put_text(bytes, plants->empty() ? std::string() : write_placed({kinds, *plants}));
    }
    return bytes;
}

Result<NamedEdit> read_named_edit(std::string_view bytes, const std::string& path) {
    const auto wrong = [&] {
        return fail(ErrorId::file_corrupt, path, "", "an edit that is not whole",
                    "a journal as coppice-editor writes it");
    };
    Reader reader(bytes);
    NamedEdit named;
    named.edit.name = reader.text();
    const uint64_t file_count = reader.number();
    for (uint64_t f = 0; f < file_count && reader.sound(); ++f) {
        FileEdit file;
        file.path = reader.text();
        if (reader.number() != 0) {
            for (SceneTextPtr* text : {&file.before, &file.after}) {
                const std::string_view written = reader.text();
                if (written.empty()) continue;
                COPPICE_TRY(*text, parse_scene_text(std::string(written), path));
            }
            if (!file.before && !file.after) return wrong();
        }
        for (std::vector<PlacedPlant>* plants : {&file.removed, &file.added}) {
            const std::string_view written = reader.text();
            if (written.empty()) continue;
            COPPICE_TRY(PlacedPlants placed, read_placed(written, path));
            const size_t first_kind = named.kinds.size();
            named.kinds.insert(named.kinds.end(), placed.kinds.begin(), placed.kinds.end());
            for (PlacedPlant& plant : placed.plants) plant.kind = uint16_t(plant.kind + first_kind);
            *plants = std::move(placed.plants);
        }
        named.edit.files.push_back(std::move(file));
    }
    if (!reader.sound() || !reader.done() || named.kinds.size() > 65536) return wrong();
    return named;
}

}  // namespace coppice
