#include "tools/coppice/bench_foliage.h"

#include <algorithm>
#include <optional>
#include <fmt/format.h>
#include "plugins/vegetation/cook/collapse_leaves.h"
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/cull/frustum.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "plugins/vegetation/eco/plant_scene.h"
#include "plugins/vegetation/lod/leaf_forest.h"
#include "runtime/core/file.h"
#include "runtime/core/progress.h"
#include "runtime/gpu/buffer.h"
#include "tools/accuracy/metrics.h"
#include "tools/accuracy/substitute_models.h"
#include "tools/coppice/figure.h"
#include "tools/coppice/machine.h"
#include "tools/coppice/method_drawer.h"
#include "tools/coppice/statistics.h"
#include "tools/coppice/stopwatch.h"
#include "tools/foliage/crown.h"
#include "tools/foliage/crown_coverage.h"
#include "tools/foliage/foliage_record.h"
#include "tools/foliage/level_plant.h"

namespace coppice {
namespace {

// Sizes: the paper tells that of Carya ovata only. The birch's and the yew's are ours.
constexpr const char* k_trees[] = {"betula_lenta", "taxus_baccata", "carya_ovata"};
constexpr uint32_t k_coarsest = 20;  // leaves over those of the coarsest level
constexpr uint32_t k_collapse_rounds = 3, k_fine_steps = 1000, k_fine_rounds = 1;
constexpr double k_level_ratio = 0.93;                // of leaves, from one level looked at to the next
constexpr double k_shown[] = {1.0, 0.75, 0.5, 0.25};  // Fig. 12
constexpr uint32_t k_picture_frames = 16;
constexpr double k_grove_levels[] = {1.0, 0.5, 0.25, 0.125, 1.0 / k_coarsest};
constexpr double k_leaf_px = 1.5;

class TreeBench {
  public:
    TreeBench(const BenchSettings& settings, std::string plant_file, std::string out)
        : settings_(settings), plant_file_(std::move(plant_file)), out_(std::move(out)) {}

    Result<FoliageRecord> run() {
        COPPICE_CHECK(load());
        COPPICE_CHECK(collapse());
        COPPICE_CHECK(sweep());
        compare_levels();
        COPPICE_CHECK(draw_levels());
        COPPICE_CHECK(draw_grove());
        return std::move(record_);
    }
    const std::string& device() const { return host_->device->name; }

  private:
    Status load() {
        PlayOptions options;
        options.scene = plant_file_;
        COPPICE_CHECK(parse_size("--size", settings_.size, options.width, options.height));
        options.headless = options.keep_scene = true;
        options.device = settings_.device;
        options.cache_dir = settings_.cache_dir;
        COPPICE_TRY(host_, PlayHost::create(options));
        const auto* modeller =
            host_->registry.find<ModellerInterface>(k_modeller_interface, k_modeller_version);
        COPPICE_TRY(description_, read_plant(plant_file_, 0, modeller, host_->find_images()));
        record_.name = description_.name;
        return {};
    }

    Status collapse() {
        COPPICE_TRY(std::vector<Leaf> leaves, find_crown(description_));
        record_.leaf_count = uint32_t(leaves.size());
        LeafCollapseSettings settings;
        settings.target_count = record_.leaf_count / k_coarsest;
        std::vector<LeafCollapse> collapses;
        std::vector<double> rounds_s;
        for (uint32_t round = 0; round < k_collapse_rounds; ++round) {
            Stopwatch clock;
            collapses = collapse_leaves(leaves, settings);
            rounds_s.push_back(clock.ms() * 1e-3);
        }
        record_.collapse_s = median(rounds_s);
        crown_.emplace(std::move(leaves), std::move(collapses));
        return {};
    }

    Status sweep() {
        const LeafForest forest = grow_leaf_forest(record_.leaf_count, crown_->collapses());
        record_.forest_words = forest.words_per_vertex();
        record_.lifetimes_words = crown_->lifetimes().words_per_vertex();
        gpu::BufferSettings buffer;
        buffer.size_bytes = sweep_words(record_.leaf_count) * sizeof(uint32_t);
        buffer.memory = gpu::MemoryUse::upload;
        buffer.name = "foliage sweep";
        COPPICE_TRY(const gpu::Buffer sent, gpu::Buffer::create(*host_->device, buffer));
        const std::span<uint32_t> target = sent.mapped_as<uint32_t>();
        record_.sweep = sweep_levels(record_.leaf_count, crown_->collapses(), target, {});
        const std::vector<SweepStep> fine =
            sweep_levels(record_.leaf_count, crown_->collapses(), target, {k_fine_steps, k_fine_rounds});
        record_.fine_vdf = sum_of(fine, FoliageStructure::vdf);
        record_.fine_lodf = sum_of(fine, FoliageStructure::lodf);
        double candidates = 0.0, drawn = 0.0;
        for (const SweepStep& step : record_.sweep) {
            candidates += step.candidate_count;
            drawn += step.leaf_count;
        }
        record_.candidates_per_leaf = drawn > 0.0 ? candidates / drawn : 0.0;
        return {};
    }

    void compare_levels() {
        const CrownCoverage coverage(crown_->leaves());
        const double full_m2 = crown_area_m2(crown_->leaves());
        const uint32_t least = record_.leaf_count - uint32_t(crown_->collapses().size());
        Progress progress(record_.name + ": coverage of its levels", record_.leaf_count - least);
        record_.dropped = measure_dropped(crown_->leaves(), coverage);
        double leaves = record_.leaf_count;
        while (leaves > double(least)) {
            leaves = std::max(leaves * k_level_ratio, double(least));
            const std::vector<Leaf> drawn = crown_->leaves_at(crown_->level_of(uint32_t(leaves)));
            progress.advance(record_.levels.empty() ? record_.leaf_count - drawn.size()
                                                    : record_.levels.back().leaf_count - drawn.size());
            record_.levels.push_back({uint32_t(drawn.size()), coverage.worst_error(drawn),
                                      full_m2 > 0.0 ? crown_area_m2(drawn) / full_m2 : 1.0});
        }
    }

    // The plant alone, without ground: what a frame takes is the crown's.
    MethodScene scene_of(Plant plant) const {
        MethodScene made;
        made.scene.name = record_.name;
        made.scene.models = {plant_scene_model(plant_file_)};
        made.scene.light = host_->scene.light;
        const Box& bounds = plant.bounds_plant;
        Placement placement{};
        placement.position_world = -dvec3(bounds.center().x, bounds.min.y, bounds.center().z);
        placement.scale = 1.0f;
        placement.turn = pack_turn_about_y(0.0f);
        make_tiles({&placement, 1}, made.scene);
        finish_tiles(made.scene, {&bounds, 1});
        made.plants.push_back(std::move(plant));
        return made;
    }

    Status draw_levels() {
        const ImagesInterface* images = host_->find_images();
        const OpennessGrid openness(description_.parts, std::vector<bool>(description_.parts.size(), false));
        const Camera camera = host_->scene.camera_path.front().camera;
        FrameSettings settings;
        settings.shadows = ShadowKind::none;
        settings.level_of_detail = false;
        MethodDrawer drawer(*host_);
        uint64_t revision = 0;
        for (double share : k_shown) {
            DrawnLevelRecord drawn{};
            const std::vector<Leaf> leaves =
                crown_->leaves_at(crown_->level_of(uint32_t(share * double(record_.leaf_count))));
            drawn.leaf_count = uint32_t(leaves.size());
            const SweepStep& step = nearest_step(drawn.leaf_count);
            const ChangeCost& vdf = step.change[size_t(FoliageStructure::vdf)];
            drawn.vdf_ms = vdf.extract_ms + vdf.copy_ms;
            drawn.ours_ms = step.change[size_t(FoliageStructure::lifetimes)].copy_ms + step.scan_ms;
            COPPICE_TRY(Plant crown, make_level_plant(host_->plants[0], leaves, openness, false));
            const MethodScene leaves_alone = scene_of(std::move(crown));
            COPPICE_TRY(const MethodDrawer::Timing timing,
                        drawer.time({&leaves_alone, settings, ++revision}, camera));
            drawn.leaves_ms = timing.frame_ms;
            COPPICE_TRY(Plant whole, make_level_plant(host_->plants[0], leaves, openness, true));
            const MethodScene tree = scene_of(std::move(whole));
            COPPICE_TRY(const FloatPicture picture,
                        drawer.picture({&tree, settings, ++revision}, camera, k_picture_frames));
            drawn.picture_file = fmt::format("{}-{}.png", stem(), drawn.leaf_count);
            if (images) COPPICE_CHECK(images->write(out_ + "/" + drawn.picture_file, encode_srgb(picture)));
            record_.drawn.push_back(drawn);
        }
        return {};
    }

    // Fig. 12, below: a grove, each plant by the coarsest level whose leaves take no more than k_leaf_px.
    Status draw_grove() {
        const ImagesInterface* images = host_->find_images();
        if (!images) return {};
        const OpennessGrid openness(description_.parts, std::vector<bool>(description_.parts.size(), false));
        SubstituteLadder ladder;
        for (double share : k_grove_levels) {
            const std::vector<Leaf> leaves =
                crown_->leaves_at(crown_->level_of(uint32_t(share * double(record_.leaf_count))));
            COPPICE_TRY(Plant plant, make_level_plant(host_->plants[0], leaves, openness, true));
            const double leaf_m =
                std::sqrt(crown_area_m2(leaves) / double(std::max<size_t>(leaves.size(), 1)));
            ladder.push_back({std::move(plant), ladder.empty() ? 0.0f : float(leaf_m)});
        }
        const MethodScene grove{host_->scene, host_->plants};
        SubstituteScenes scenes(grove, {std::move(ladder)});
        const Camera camera = host_->scene.camera_path.front().camera;
        const float focal_px = make_frustum(camera, host_->width, host_->height).focal_px;
        const SubstituteScenes::Choice choice = scenes.choose(camera, focal_px, k_leaf_px);
        FrameSettings settings;
        settings.shadows = ShadowKind::none;
        settings.level_of_detail = false;
        MethodDrawer drawer(*host_);
        COPPICE_TRY(const FloatPicture picture,
                    drawer.picture({choice.scene, settings, choice.revision}, camera, 1));
        record_.grove_file = stem() + "-grove.png";
        return images->write(out_ + "/" + record_.grove_file, encode_srgb(picture));
    }

    const SweepStep& nearest_step(uint32_t leaf_count) const {
        return *std::min_element(record_.sweep.begin(), record_.sweep.end(),
                                 [&](const SweepStep& a, const SweepStep& b) {
                                     auto away = [&](const SweepStep& s) {
                                         return std::abs(double(s.leaf_count) - double(leaf_count));
                                     };
                                     return away(a) < away(b);
                                 });
    }
    std::string stem() const { return plant_scene_model(plant_file_).name; }

    const BenchSettings& settings_;
    std::string plant_file_, out_;
    std::unique_ptr<PlayHost> host_;
    PlantDescription description_;
    std::optional<Crown> crown_;
    FoliageRecord record_;
};

double share_of(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

void add_figures(const std::string& plant, const FoliageRecord& record, std::vector<Figure>& figures) {
    auto add = [&](const char* what, double value, const char* unit, std::optional<double> reach = {}) {
        figures.push_back({plant + ": " + what, value, unit, reach, Reach::at_most});
    };
    const SweepSum vdf = sum_of(record.sweep, FoliageStructure::vdf),
                   lodf = sum_of(record.sweep, FoliageStructure::lodf),
                   ours = sum_of(record.sweep, FoliageStructure::lifetimes);
    add("leaves", record.leaf_count, "");
    add("VDF extraction", share_of(vdf.extract_ms, double(record.sweep.size())), "ms a step");
    add("LoDF / VDF extraction", 100.0 * share_of(lodf.extract_ms, vdf.extract_ms), "%");
    add("LoDF / VDF bytes", 100.0 * share_of(lodf.bytes, vdf.bytes), "%");
    add("in 1,000 steps, extraction",
        100.0 * share_of(record.fine_lodf.extract_ms, record.fine_vdf.extract_ms), "%");
    add("in 1,000 steps, bytes", 100.0 * share_of(record.fine_lodf.bytes, record.fine_vdf.bytes), "%");
    add("ours / VDF extraction", 100.0 * share_of(ours.extract_ms, vdf.extract_ms), "%", 5.0);
    add("ours / VDF bytes", 100.0 * share_of(ours.bytes, vdf.bytes), "%", 5.0);
    add("ours / VDF and copy", 100.0 * share_of(ours.change_ms, vdf.change_ms), "%");
    double scan_ms = 0.0, vdf_total_ms = 0.0, ours_total_ms = 0.0, coverage = 0.0, area = 0.0;
    for (const SweepStep& step : record.sweep) scan_ms += step.scan_ms;
    for (const DrawnLevelRecord& drawn : record.drawn) {
        vdf_total_ms += drawn.vdf_ms + drawn.leaves_ms;
        ours_total_ms += drawn.ours_ms + drawn.leaves_ms;
    }
    for (const CrownLevelRecord& level : record.levels) {
        coverage = std::max(coverage, level.coverage_error);
        area = std::max(area, std::abs(level.area - 1.0));
    }
    add("ours, scan / VDF extr.", 100.0 * share_of(scan_ms, vdf.extract_ms), "%");
    add("ours, looked at for one", record.candidates_per_leaf, "");
    add("ours / VDF with drawing", 100.0 * share_of(ours_total_ms, vdf_total_ms), "%", 10.0);
    add("collapse", record.collapse_s, "s", 5.0);
    add("LoDF storage", record.forest_words, "words/vert", 6.25);
    add("ours, storage", record.lifetimes_words, "words/vert", 6.25);
    add("coverage off by", 100.0 * coverage, "%", 2.0);
    if (!record.dropped.empty()) {
        const DroppedErrors& thinnest = record.dropped.back();
        add("dropped to 1/20, w = 1", 100.0 * thinnest.whole, "%");
        add("the same, golden section", 100.0 * thinnest.whole_golden, "%");
        add("the same, as printed", 100.0 * thinnest.whole_printed, "%");
        add("dropped to 1/20, tolerant", 100.0 * thinnest.tolerant, "%");
    }
    add("area off by", 100.0 * area, "%", 1.0);
}

}  // namespace

Result<nlohmann::json> bench_foliage(const BenchSettings& settings) {
    const std::string out = settings.out.empty() ? "out/foliage" : settings.out;
    std::vector<std::string> plant_files;
    if (!settings.scene.empty()) {
        plant_files.push_back(settings.scene);
    } else {
        for (const char* tree : k_trees)
            plant_files.push_back(fmt::format("{}/species/{}.json", settings.content, tree));
    }
    std::vector<FoliageRecord> records;
    std::vector<Figure> figures;
    std::string device;
    for (const std::string& file : plant_files) {
        TreeBench bench(settings, file, out);
        COPPICE_TRY(records.emplace_back(), bench.run());
        device = bench.device();
        add_figures(plant_scene_model(file).name, records.back(), figures);
    }
    const Machine machine = describe_machine();
    COPPICE_CHECK(write_text_file(out + "/index.html",
                                  foliage_page(records, device, machine.processor, command_line())));
    fmt::print("{}/index.html\n", out);
    nlohmann::json list = nlohmann::json::array(), plants = list;
    for (const Figure& figure : figures) list.push_back(to_json(figure));
    for (const FoliageRecord& record : records) plants.push_back(foliage_json(record));
    return nlohmann::json{
        {"name", "foliage"},          {"device", device},           {"machine", machine.processor},
        {"threads", machine.threads}, {"figures", std::move(list)}, {"plants", std::move(plants)}};
}

}  // namespace coppice
