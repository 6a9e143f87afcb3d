// The list of all methods: those that draw an author's plants as cooked, and those that draw stand-ins.
#include "tools/accuracy/method.h"

#include <optional>
#include <utility>
#include "plugins/vegetation/cook/cook_file.h"
#include "plugins/vegetation/eco/make_tiles.h"
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"
#include "runtime/core/progress.h"
#include "tools/accuracy/crossed_billboards.h"
#include "tools/accuracy/substitute_models.h"
#include "tools/accuracy/vertex_merging.h"

namespace coppice {
namespace {

constexpr float k_paper_splat_factor = 1.3f;  // Deussen et al. 2002 say 1.2 to 1.5

// Levels of detail are compared without shadows, against the reference without them; shadows by methods of their own.
FrameSettings unshadowed() {
    FrameSettings settings;
    settings.shadows = ShadowKind::none;
    return settings;
}

class FullMethod final : public AccuracyMethod {
  public:
    FullMethod(uint32_t samples, float filter_radius_px)
        : samples_(samples), filter_radius_px_(filter_radius_px) {}
    std::string name() const override {
        if (filter_radius_px_ > 1.0f) return "full, filtered";
        return samples_ == 1 ? "full, 1 sample" : "full, " + std::to_string(samples_) + " samples";
    }
    std::string what() const override {
        return "Every triangle, " +
               (samples_ == 1 ? "one sample a pixel" : std::to_string(samples_) + " samples a pixel") +
               (filter_radius_px_ > 1.0f ? ", under the pixel filter of the defaults." : ".");
    }
    std::string quality_name() const override { return ""; }
    std::vector<double> qualities() const override { return {1.0}; }
    double default_quality() const override { return 1.0; }
    uint32_t samples_per_pixel() const override { return samples_; }
    Status prepare(const MethodInput& input) override {
        original_ = input.original;
        return {};
    }
    Result<DrawnFrame> frame(const Camera&, float, double) override {
        FrameSettings settings = unshadowed();
        settings.level_of_detail = false;
        settings.filter_radius_px = filter_radius_px_;
        return DrawnFrame{original_, settings};
    }

  private:
    uint32_t samples_;
    float filter_radius_px_;
    const MethodScene* original_ = nullptr;
};

// Points, lines and triangles by d'; quality is d'.
struct Hybrid {
    const char* name;
    const char* what;
    FrameSettings settings;
    std::optional<CookSettings> cook;  // where the plants are cooked another way
    bool is_default = false;           // swept in finer steps
};

class HybridMethod final : public AccuracyMethod {
  public:
    explicit HybridMethod(Hybrid hybrid) : hybrid_(std::move(hybrid)) {}
    std::string name() const override { return hybrid_.name; }
    std::string what() const override { return hybrid_.what; }
    std::string quality_name() const override { return "d' px"; }
    std::vector<double> qualities() const override {
        return hybrid_.is_default ? std::vector<double>{0.5, 0.71, 1.0, 1.41, 2.0, 2.83, 4.0, 5.66, 8.0}
                                  : std::vector<double>{0.5, 1.0, 2.0, 4.0, 8.0};
    }
    double default_quality() const override { return 1.0; }

    Status prepare(const MethodInput& input) override {
        drawn_ = input.original;
        if (!hybrid_.cook) return {};
        const Scene& scene = input.original->scene;
        std::vector<PlantSource> sources;
        for (const SceneModel& model : scene.models) {
            sources.push_back({model.source_path, model.variation});
            if (model.source_path.ends_with(".plant"))
                log_warning("{}: packed already, so \"{}\" draws it as it is", model.source_path, name());
        }
        COPPICE_TRY(cooked_.plants,
                    find_or_cook(input.cache_dir, sources, *hybrid_.cook, input.modeller, input.images));
        cooked_.scene = scene;
        std::vector<Box> bounds;
        for (const Plant& plant : cooked_.plants) bounds.push_back(plant.bounds_plant);
        finish_tiles(cooked_.scene, bounds);
        drawn_ = &cooked_;
        return {};
    }

    Result<DrawnFrame> frame(const Camera&, float, double quality) override {
        FrameSettings settings = hybrid_.settings;
        settings.sample_distance_px = float(quality);
        return DrawnFrame{drawn_, settings};
    }

  private:
    Hybrid hybrid_;
    MethodScene cooked_;
    const MethodScene* drawn_ = nullptr;
};

std::vector<Hybrid> hybrids() {
    FrameSettings isotropic = unshadowed();
    isotropic.projection = ProjectionMode::isotropic;
    isotropic.splat_factor = k_paper_splat_factor;
    isotropic.filter_radius_px = 1.0f;  // the paper has neither
    isotropic.weigh_by_facing = false;
    FrameSettings printed = isotropic;
    printed.projection = ProjectionMode::printed;
    FrameSettings unfiltered = unshadowed();
    unfiltered.filter_radius_px = 1.0f;
    FrameSettings alike = unshadowed();
    alike.weigh_by_facing = false;
    FrameSettings no_leaves = unshadowed();
    no_leaves.foliage = FoliageMode::points;
    FrameSettings leaves = unshadowed();
    leaves.foliage = FoliageMode::leaves;
    FrameSettings unblended = unshadowed();
    unblended.blend = false;
    CookSettings shuffled;
    shuffled.order = PrefixOrder::shuffled;
    CookSettings points;
    points.lines = LineParts::none;
    CookSettings leaf_lines;
    leaf_lines.lines = LineParts::slender;
    return {
        {"hybrid, measured", "Points, lines and triangles by measured projections: the program's defaults, without shadows.",
         unshadowed(), std::nullopt, true},
        {"hybrid, no leaves", "The defaults, but leaves are never joined: triangles and points alone.",
         no_leaves, std::nullopt, true},
        {"reduced leaves", "Leaves joined two by two wherever a part has them, before points.", leaves,
         std::nullopt, true},
        {"hybrid, isotropic",
         "The paper's hybrid with pi/4 of the lines' length for any direction, splat factor 1.3.", isotropic,
         leaf_lines},
        {"hybrid, printed", "The paper's hybrid, its formulas as printed, splat factor 1.3.", printed,
         leaf_lines},
        {"hybrid, unfiltered", "The defaults, but each pixel shows its own sample alone.", unfiltered,
         std::nullopt},
        {"hybrid, equal splats", "The defaults, but splats of one size, however they face.", alike,
         std::nullopt},
        {"hybrid, unblended", "The defaults, but points give way to triangles at once.", unblended,
         std::nullopt},
        {"hybrid, random order", "The defaults, but primitives come in the paper's random order.",
         unshadowed(), shuffled},
        {"points only", "The defaults, but stems turn into points as leaves do: no lines.", unshadowed(),
         points},
        {"lines for needles", "The defaults, but needles and blades turn into lines, as in the paper.",
         unshadowed(), leaf_lines},
    };
}

// The defaults with shadows; quality is how large a texel is.
class ShadowMethod final : public AccuracyMethod {
  public:
    ShadowMethod(const char* name, const char* what, ShadowKind kind) : name_(name), what_(what), kind_(kind) {}
    std::string name() const override { return name_; }
    std::string what() const override { return what_; }
    std::string quality_name() const override { return "1024 / side"; }
    // Twelve nested maps of more texels a side are larger than a buffer may be.
    std::vector<double> qualities() const override {
        return kind_ == ShadowKind::clipmap ? std::vector<double>{1.0, 4.0 / 3.0, 2.0, 3.0}
                                            : std::vector<double>{0.25, 0.5, 1.0, 1.5, 2.0};
    }
    double default_quality() const override { return 1.0; }
    Status prepare(const MethodInput& input) override {
        original_ = input.original;
        return {};
    }
    Result<DrawnFrame> frame(const Camera&, float, double quality) override {
        FrameSettings settings;
        settings.shadows = kind_;
        settings.shadow_side_texels = uint32_t(1024.0 / quality);
        return DrawnFrame{original_, settings};
    }

  private:
    const char *name_, *what_;
    ShadowKind kind_;
    const MethodScene* original_ = nullptr;
};

// Every plant by the level of its ladder that suits its distance; quality is the grain in pixels.
struct Substitute {
    const char* name;
    const char* what;
    const char* quality_name;
    std::vector<double> qualities;
    double default_quality;
    Result<SubstituteLadder> (*make_ladder)(const Plant& plant);
};

class SubstituteMethod final : public AccuracyMethod {
  public:
    explicit SubstituteMethod(Substitute substitute) : substitute_(std::move(substitute)) {}
    std::string name() const override { return substitute_.name; }
    std::string what() const override { return substitute_.what; }
    std::string quality_name() const override { return substitute_.quality_name; }
    std::vector<double> qualities() const override { return substitute_.qualities; }
    double default_quality() const override { return substitute_.default_quality; }

    Status prepare(const MethodInput& input) override {
        const std::vector<Plant>& plants = input.original->plants;
        std::vector<Result<SubstituteLadder>> made(plants.size());
        Progress progress("making plants of " + name(), plants.size());
        parallel_for(plants.size(), 1, [&](size_t first, size_t last) {
            for (size_t i = first; i < last; ++i) {
                made[i] = substitute_.make_ladder(plants[i]);
                progress.advance();
            }
        });
        std::vector<SubstituteLadder> ladders;
        for (Result<SubstituteLadder>& one : made) {
            COPPICE_TRY(SubstituteLadder ladder, std::move(one));
            ladders.push_back(std::move(ladder));
        }
        scenes_ = std::make_unique<SubstituteScenes>(*input.original, std::move(ladders));
        return {};
    }

    Result<DrawnFrame> frame(const Camera& camera, float focal_px, double quality) override {
        const SubstituteScenes::Choice choice = scenes_->choose(camera, focal_px, quality);
        FrameSettings settings = unshadowed();
        settings.sample_distance_px = float(quality);
        settings.weigh_by_facing = false;  // a billboard's texels are no leaves
        return DrawnFrame{choice.scene, settings, choice.revision};
    }

  private:
    Substitute substitute_;
    std::unique_ptr<SubstituteScenes> scenes_;
};

std::vector<Substitute> substitutes() {
    return {
        {"vertex merging",
         "Triangles only, vertices merged in the cells of a grid (Rossignac and Borrel 1993).",
         "cell px",
         {0.5, 1.0, 2.0, 4.0, 8.0, 16.0},
         1.0,
         &make_vertex_merging_ladder},
        {"crossed billboards",
         "Three textured planes crossing in the middle of each plant; near ones with all their triangles.",
         "d' px",
         {0.71, 1.0, 1.41, 2.0, 2.83, 4.0},
         1.0,
         &make_crossed_billboards_ladder},
    };
}

}  // namespace

std::vector<std::unique_ptr<AccuracyMethod>> make_accuracy_methods() {
    std::vector<std::unique_ptr<AccuracyMethod>> methods;
    const float filtered_px = FrameSettings{}.filter_radius_px;
    methods.push_back(std::make_unique<FullMethod>(1, 1.0f));
    methods.push_back(std::make_unique<FullMethod>(4, 1.0f));
    methods.push_back(std::make_unique<FullMethod>(1, filtered_px));
    for (Hybrid& hybrid : hybrids()) methods.push_back(std::make_unique<HybridMethod>(std::move(hybrid)));
    methods.push_back(std::make_unique<ShadowMethod>(
        "shadows, uniform", "The defaults with a shadow map that is as fine far away as near.",
        ShadowKind::uniform));
    methods.push_back(std::make_unique<ShadowMethod>(
        "shadows, perspective",
        "The defaults with a perspective shadow map (Stamminger and Drettakis 2002).",
        ShadowKind::perspective));
    methods.push_back(std::make_unique<ShadowMethod>(
        "shadows, light space", "The defaults with a light-space perspective shadow map (Wimmer et al. 2004).",
        ShadowKind::light_space));
    methods.push_back(std::make_unique<ShadowMethod>(
        "shadows, clipmap", "The defaults with nested shadow maps, which are made once for a view.",
        ShadowKind::clipmap));
    for (Substitute& substitute : substitutes())
        methods.push_back(std::make_unique<SubstituteMethod>(std::move(substitute)));
    return methods;
}

}  // namespace coppice
