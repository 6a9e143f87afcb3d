// Tells the leaves of a mesh apart: two triangles belong to one element where they share a corner's position.
#pragma once
#include "plugins/vegetation/cook/import/import_mesh.h"

namespace coppice {

// Fills elements and element_count; elements are numbered by their first triangle.
void find_elements(ImportMesh& mesh);

}  // namespace coppice
