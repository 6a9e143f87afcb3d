#include "plugins/vegetation/eco/place_plants.h"

#include <algorithm>
#include <cmath>
#include "plugins/vegetation/eco/ground_height.h"
#include "runtime/core/hash.h"
#include "runtime/core/jobs.h"

namespace coppice {
namespace {

constexpr size_t k_run = 4096;               // plants of one job
constexpr size_t k_batch = size_t(1) << 16;  // runs that wait; bounds the memory of millions of small copies

enum class Standing { root, ground, rigid };

// A file's own space in the world.
struct Frame {
    dvec3 origin{0.0};  // y only where rigid
    double cosine = 1.0, sine = 0.0, scale = 1.0;
    Standing standing = Standing::root;
    uint64_t seed = 0;

    dvec3 turned(dvec3 p) const { return {cosine * p.x + sine * p.z, p.y, cosine * p.z - sine * p.x}; }
    // Heights count from the ground below, or from the origin.
    dvec3 place(dvec3 p, const Terrain* terrain) const {
        dvec3 at = origin + turned(p) * scale;
        if (standing == Standing::ground) at.y = ground_height(terrain, at.x, at.z) + p.y * scale;
        return at;
    }
};

// Exact at whole quarters, so that squares turned by them still meet.
void turn_by(Frame& frame, double turn_deg) {
    double quarters = std::floor(turn_deg / 90.0 + 0.5);
    float rest_rad = float(turn_deg - quarters * 90.0) * (k_pi / 180.0f);
    double c = double(portable_cos(rest_rad)), s = double(portable_sin(rest_rad));
    double length = std::sqrt(c * c + s * s);
    c /= length;
    s /= length;
    for (int64_t q = (int64_t(quarters) % 4 + 4) % 4; q > 0; --q) {
        std::swap(c, s);
        c = -c;
    }
    double cosine = frame.cosine * c - frame.sine * s;
    frame.sine = frame.sine * c + frame.cosine * s;
    frame.cosine = cosine;
}

Frame frame_of(const Frame& parent, const SceneReference& reference, uint32_t index, uint64_t copy,
               const Terrain* terrain) {
    Frame frame = parent;
    dvec3 step(double(copy % reference.columns) - 0.5 * (reference.columns - 1), 0.0,
               double(copy / reference.columns) - 0.5 * (reference.rows - 1));
    Frame grid;
    turn_by(grid, reference.turn_deg);
    frame.origin = parent.place(reference.at + grid.turned(step) * reference.spacing_m, terrain);
    turn_by(frame, reference.turn_deg + std::fmod(double(copy) * reference.turn_step_deg, 360.0));
    frame.scale *= reference.scale;
    if (parent.standing != Standing::rigid)
        frame.standing = reference.on_ground ? Standing::ground : Standing::rigid;
    frame.seed = hash_combine(parent.seed, uint64_t(index) << 32 | copy);
    return frame;
}

PlantTurn turned(const Frame& frame, PlantTurn turn) {
    float w = float(std::sqrt(std::max(0.0, 0.5 + 0.5 * frame.cosine)));
    float y = float(std::copysign(std::sqrt(std::max(0.0, 0.5 - 0.5 * frame.cosine)), frame.sine));
    float qx = turn.x, qy = turn.y, qz = turn.z, qw = turn.w;
    return pack_turn(w * qx + y * qz, w * qy + y * qw, w * qz - y * qx, w * qw - y * qy);
}

// Leans as far as the ground does, by the shortest way from upright.
PlantTurn leaned(PlantTurn turn, vec3 tip) {
    float w = std::sqrt(std::max(0.0f, 0.5f + 0.5f * tip.y));
    float x = 0.5f * tip.z / w, z = -0.5f * tip.x / w;
    float qx = turn.x, qy = turn.y, qz = turn.z, qw = turn.w;
    return pack_turn(w * qx + x * qw - z * qy, w * qy + z * qx - x * qz, w * qz + x * qy + z * qw,
                     w * qw - x * qx - z * qz);
}

// Some plants of one group, where one copy of it stands.
struct Run {
    const SceneNode* node;
    const PlantGroup* group;
    size_t first_plant, plant_count;
    Frame frame;
    size_t first_placed;
};

class Placer {
  public:
    Placer(const SceneTree& tree, const Terrain* terrain, std::vector<Placement>& placed)
        : tree_(tree), terrain_(terrain), placed_(placed) {}

    // The plants of a node and of all it refers to, from placed[first] on.
    void place(const SceneNode& node, const Frame& frame, size_t first) {
        if (frame.standing != Standing::root)
            for (const PlantGroup& group : node.file.groups)
                for (size_t begin = 0; begin < group.plants.size(); begin += k_run) {
                    size_t count = std::min(k_run, group.plants.size() - begin);
                    runs_.push_back({&node, &group, begin, count, frame, first});
                    first += count;
                    if (runs_.size() == k_batch) flush();
                }
        for (size_t r = 0; r < node.children.size(); ++r) {
            const SceneReference& reference = node.file.references[r];
            const SceneNode& child = tree_.nodes[node.children[r]];
            for (uint64_t copy = 0; copy < reference.copy_count(); ++copy) {
                place(child, frame_of(frame, reference, uint32_t(r), copy, terrain_), first);
                first += child.plant_count;
            }
        }
    }

    void flush() {
        parallel_for(runs_.size(), 8, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) place_run(runs_[i]);
        });
        runs_.clear();
    }

  private:
    // A plant that is refused is left with scale 0.
    void place_run(const Run& run) {
        const GroundRule& rule = run.group->rule;
        const float least_up = rule.least_up();
        for (size_t i = 0; i < run.plant_count; ++i) {
            Placement& plant = placed_[run.first_placed + i];
            plant = run.group->plants[run.first_plant + i];
            plant.position_world = run.frame.place(plant.position_world, terrain_);
            plant.turn = turned(run.frame, plant.turn);
            plant.scale = float(double(plant.scale) * run.frame.scale);
            plant.model.model = run.node->models[plant.model.model];
            plant.model.seed = mix_bits(plant.model.seed ^ uint32_t(run.frame.seed));
            if (rule == GroundRule{}) continue;
            vec3 normal(0, 1, 0);
            double height = plant.position_world.y;
            if (run.frame.standing == Standing::ground) {
                normal = ground_normal(terrain_, plant.position_world.x, plant.position_world.z);
                height = ground_height(terrain_, plant.position_world.x, plant.position_world.z);
            }
            if (normal.y < least_up || !rule.takes_height(height)) plant.scale = 0.0f;
            if (rule.align_to_ground > 0.0f) plant.turn = leaned(plant.turn, rule.tip(vec3(0, 1, 0), normal));
        }
    }

    const SceneTree& tree_;
    const Terrain* terrain_;
    std::vector<Placement>& placed_;
    std::vector<Run> runs_;
};

}  // namespace

std::vector<Placement> place_plants(SceneTree& tree) {
    SceneNode& root = tree.nodes.back();
    std::vector<Placement> placed;
    if (!root.file.groups.empty()) placed = std::move(root.file.groups.front().plants);
    size_t own_count = placed.size();
    placed.resize(root.plant_count);
    Placer placer(tree, root.file.scene.terrain.get(), placed);
    placer.place(root, {}, own_count);
    placer.flush();
    std::erase_if(placed, [](const Placement& plant) { return plant.scale == 0.0f; });
    return placed;
}

}  // namespace coppice
