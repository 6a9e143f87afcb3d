// A way to draw a scene, with one number that trades time for error. methods.cpp lists them all; a new one adds itself
// there and is measured with the others.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>
#include "plugins/images/images.h"
#include "plugins/modeller/modeller.h"
#include "plugins/vegetation/eco/scene.h"
#include "plugins/vegetation/lod/settings.h"
#include "plugins/vegetation/plant/plant.h"

namespace coppice {

// What a method draws: a scene, and a packed plant for each of its models.
struct MethodScene {
    Scene scene;
    std::vector<Plant> plants;
};

struct MethodInput {
    const MethodScene* original;  // as the program draws it, tiles finished; outlives the method
    std::string cache_dir;        // of cooked plants
    const ModellerInterface* modeller;
    const ImagesInterface* images;
};

struct DrawnFrame {
    const MethodScene* scene;  // unchanged until the method has made four others
    FrameSettings settings;
    // With the same scene and the same revision nothing needs to be uploaded again. A scene's address alone says
    // too little: it may have been another scene's before.
    uint64_t revision = 0;
};

class AccuracyMethod {
  public:
    virtual ~AccuracyMethod() = default;
    virtual std::string name() const = 0;          // "hybrid, measured"
    virtual std::string what() const = 0;          // one sentence
    virtual std::string quality_name() const = 0;  // "d' px"; "" where there is nothing to sweep
    // From the finest to the coarsest; at least one.
    virtual std::vector<double> qualities() const = 0;
    virtual double default_quality() const = 0;               // one of them
    virtual uint32_t samples_per_pixel() const { return 1; }  // frames, each at another place of the pixel
    // Once, before the first frame; may take long. Errors: of the cook.
    virtual Status prepare(const MethodInput& input) = 0;
    // focal_px: pixels of the picture a metre takes at a distance of a metre.
    virtual Result<DrawnFrame> frame(const Camera& camera, float focal_px, double quality) = 0;
};

// In the order they are shown; the first is every triangle at one sample a pixel.
std::vector<std::unique_ptr<AccuracyMethod>> make_accuracy_methods();

}  // namespace coppice
