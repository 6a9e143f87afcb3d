// What one step of work changes, with all that undoing it needs.
#pragma once
#include <string>
#include <string_view>
#include <vector>
#include "editor/document/scene_text.h"
#include "plugins/vegetation/eco/placed_plants.h"
#include "runtime/core/result.h"

namespace coppice {

struct FileEdit {
    std::string path;
    SceneTextPtr before,
        after;  // the same: the text stays; no before: the file is new, no after: it is gone again
    std::vector<PlacedPlant> removed, added;  // kinds: Document::kinds

    bool empty() const { return before == after && removed.empty() && added.empty(); }
};

struct Edit {
    std::string name;  // "paint 350 birch"
    std::vector<FileEdit> files;

    bool empty() const;
};

// Taken one behind the other, in either order, both change nothing.
Edit inverse(Edit edit);

// As bytes; kinds by their names, so that they hold for another run. kind_of(name) -> the number of a kind.
std::string write_edit(const Edit& edit, const std::vector<std::string>& kinds);
// Of the same folder: paths are kept from there. Errors: file_corrupt.
template <class KindOf>
Result<Edit> read_edit(std::string_view bytes, const std::string& path, KindOf&& kind_of);

// What read_edit does, with the kinds as numbers in a list of its own.
struct NamedEdit {
    Edit edit;
    std::vector<std::string> kinds;
};
Result<NamedEdit> read_named_edit(std::string_view bytes, const std::string& path);
template <class KindOf>
Edit numbered(NamedEdit named, KindOf&& kind_of);

template <class KindOf>
Result<Edit> read_edit(std::string_view bytes, const std::string& path, KindOf&& kind_of) {
    COPPICE_TRY(NamedEdit named, read_named_edit(bytes, path));
    return numbered(std::move(named), kind_of);
}

template <class KindOf>
Edit numbered(NamedEdit named, KindOf&& kind_of) {
    std::vector<uint16_t> numbers;
    for (const std::string& name : named.kinds) numbers.push_back(kind_of(name));
    for (FileEdit& file : named.edit.files)
        for (std::vector<PlacedPlant>* plants : {&file.removed, &file.added})
            for (PlacedPlant& plant : *plants) plant.kind = numbers[plant.kind];
    return std::move(named.edit);
}

}  // namespace coppice
