// All plants of a scene and of those it refers to, in the root's world: turned, scaled, moved, and on the root's ground.
#pragma once
#include <vector>
#include "plugins/vegetation/eco/scene_tree.h"

namespace coppice {

// The root's plants as they are, then its references' in order, copies by rows. A copy's plants have seeds of their own,
// mixed from the references that lead to it; they follow the ground unless a reference with a height of its own leads
// there, and those whose rule the ground does not keep are left out. Takes the plants out of the tree's root.
// Deterministic on any number of threads.
std::vector<Placement> place_plants(SceneTree& tree);

}  // namespace coppice
