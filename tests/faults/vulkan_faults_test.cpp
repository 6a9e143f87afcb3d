// Every call of Vulkan that can fail fails once, each in its turn: there is an error that names it, or a frame that says what it
// lacks; nothing is left behind; and the same objects work when it does not fail any more.
#include "tests/faults/vulkan_faults.h"

#include <set>
#include "plugins/vegetation/cook/cook_plant.h"
#include "tests/cook/shapes.h"
#include "tests/stability/drawn_scene.h"

namespace coppice {
namespace {

constexpr uint32_t k_width = 64, k_height = 40, k_slots = 2;
constexpr uint64_t k_most_calls = 100000;

Plant tuft() {
    PlantDescription tuft;
    tuft.name = "tuft";
    tuft.parts.push_back(shapes::leaf_cloud(200, 0.4f, 0.08f, 5, vec3(0, 0.5f, 0)));
    auto bytes = cook_plant(tuft, {});
    EXPECT_TRUE(bytes);
    auto plant = load_plant_from_memory(std::make_shared<std::vector<std::byte>>(std::move(*bytes)), "tuft");
    EXPECT_TRUE(plant);
    return plant ? *plant : Plant{};
}

// Of a host: what it makes once, and frames.
struct Host {
    explicit Host(gpu::Device& of) : device(of) {}

    Status create() {
        COPPICE_CHECK(registry.load("vegetation"));
        const auto* interface =
            registry.find<VegetationInterface>(k_vegetation_interface, k_vegetation_version);
        COPPICE_TRY(ring, gpu::CommandRing::create(device, k_slots));
        VegetationSettings settings{&device, &world, &schedule, &graph, k_slots, k_width, k_height};
        settings.loose_tiles = 1;
        COPPICE_TRY(vegetation, interface->create(settings));
        return {};
    }

    // A scene and pictures of it: near, from further away with another kind of shadows, of another size.
    Result<std::vector<uint32_t>> play(const Scene& scene, const std::vector<Plant>& plants) {
        std::vector<uint32_t> pictures;
        COPPICE_CHECK(vegetation->resize(k_width, k_height));
        COPPICE_CHECK(vegetation->set_scene(scene, plants));
        COPPICE_CHECK(draw(3.0, ShadowKind::clipmap, k_width * k_height, pictures));
        COPPICE_CHECK(draw(20.0, ShadowKind::light_space, k_width * k_height, pictures));
        COPPICE_CHECK(vegetation->resize(2 * k_width, k_height));
        COPPICE_CHECK(draw(6.0, ShadowKind::clipmap, 2 * k_width * k_height, pictures));
        return pictures;
    }

    Status draw(double away_m, ShadowKind shadows, size_t pixels, std::vector<uint32_t>& pictures) {
        FrameSettings settings;
        settings.shadows = shadows;
        Camera camera;
        camera.position_world = dvec3(0.0, 0.5, away_m);
        // A list that did not fit is drawn again; one for which there is no room is not.
        for (int tries = 0; tries < 3; ++tries) {
            COPPICE_TRY(const gpu::CommandRing::Frame frame, ring.begin());
            vegetation->set_slot(frame.slot);
            vegetation->set_camera(camera);
            vegetation->set_settings(settings);
            schedule.run();
            graph.record(frame.commands, frame.timestamps);
            COPPICE_CHECK(ring.submit());
            COPPICE_CHECK(ring.wait(frame.serial));
            if (vegetation->report().dropped_entries == 0) break;
        }
        lacks =
            lacks || vegetation->report().dropped_entries > 0 || vegetation->report().shadow_side_texels == 0;
        std::vector<uint32_t> colors(pixels);
        COPPICE_CHECK(
            gpu::read_now(device, vegetation->color(), 0, std::as_writable_bytes(std::span(colors))));
        pictures.insert(pictures.end(), colors.begin(), colors.end());
        return {};
    }

    gpu::Device& device;
    bool lacks = false;  // a frame's report says so
    Registry registry;
    World world;
    Schedule schedule{world};
    FrameGraph graph;
    std::unique_ptr<Vegetation> vegetation;
    gpu::CommandRing ring;
};

class VulkanFaults : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        faults::watch_vulkan();
        plants_.push_back(tuft());
        std::vector<Placement> placements;
        for (int i = 0; i < 20; ++i)
            placements.push_back({dvec3(0.3 * (i % 5) - 0.6, 0.0, -0.5 * (i / 5)),
                                  1.0f,
                                  PlantTurn{0, 0, 0, 32767},
                                  {0, uint32_t(i) * 0x9e3779b9u}});
        scene_.models.resize(1);
        make_tiles(placements, scene_);
        finish_tiles(scene_, std::vector<Box>{plants_[0].bounds_plant});
    }
    static std::unique_ptr<gpu::Device> device() {
        auto device = gpu::Device::create({});
        EXPECT_TRUE(device) << to_string(device.error());
        return device ? std::move(*device) : nullptr;
    }

    static inline Scene scene_;
    static inline std::vector<Plant> plants_;
};

TEST_F(VulkanFaults, ADeviceIsMadeOrAnErrorSaysWhyNot) {
    ASSERT_EQ(faults::live_objects(), 0);
    std::set<std::string> struck;
    for (uint64_t n = 0; n < k_most_calls; ++n) {
        gpu::DeviceSettings settings;
        settings.validation = true;
        faults::fail_nth(n, VK_ERROR_OUT_OF_HOST_MEMORY);
        {
            auto device = gpu::Device::create(settings);
            auto ring =
                device ? gpu::CommandRing::create(**device, k_slots) : tl::unexpected<Error>(device.error());
            const std::string failed = faults::stop_failing();
            EXPECT_EQ(bool(ring), failed.empty()) << failed;
            if (failed.empty()) break;
            struck.insert(failed);
            if (!ring) {
                EXPECT_FALSE(to_string(ring.error()).empty());
            }
        }
        ASSERT_EQ(faults::live_objects(), 0) << "left behind after the failure of call " << n;
    }
    EXPECT_EQ(faults::live_objects(), 0);
    for (const char* call :
         {"vkCreateInstance", "vkCreateDevice", "vkCreateSemaphore", "vkCreateCommandPool"})
        EXPECT_TRUE(struck.contains(call)) << call;
}

TEST_F(VulkanFaults, APluginIsMadeOrAnErrorSaysWhyNot) {
    const auto device = this->device();
    ASSERT_TRUE(device);
    const int64_t of_device = faults::live_objects();
    std::set<std::string> struck;
    for (uint64_t n = 0; n < k_most_calls; ++n) {
        faults::fail_nth(n, VK_ERROR_OUT_OF_DEVICE_MEMORY);
        {
            Host host(*device);
            const Status made = host.create();
            const std::string failed = faults::stop_failing();
            if (failed.empty()) {
                EXPECT_TRUE(made);
                break;
            }
            struck.insert(failed);
            // Memory of one kind may stand in for that of another.
            EXPECT_TRUE(!made || failed == "vkAllocateMemory") << failed;
        }
        ASSERT_EQ(faults::live_objects(), of_device) << "left behind after the failure of call " << n;
    }
    for (const char* call :
         {"vkCreateComputePipelines", "vkCreateBuffer", "vkBindBufferMemory", "vkMapMemory"})
        EXPECT_TRUE(struck.contains(call)) << call;
}

TEST_F(VulkanFaults, FramesAreWholeOrSayWhatTheyLackAndTheNextOnesAreWhole) {
    const auto device = this->device();
    ASSERT_TRUE(device);
    Host host(*device);
    ASSERT_TRUE(host.create());
    const auto whole = host.play(scene_, plants_);
    ASSERT_TRUE(whole) << to_string(whole.error());
    ASSERT_FALSE(host.lacks);
    ASSERT_EQ(*host.play(scene_, plants_), *whole);
    const int64_t of_host = faults::live_objects();
    std::set<std::string> struck;
    for (uint64_t n = 0; n < k_most_calls; ++n) {
        host.lacks = false;
        faults::fail_nth(n, VK_ERROR_OUT_OF_DEVICE_MEMORY);
        const auto pictures = host.play(scene_, plants_);
        const std::string failed = faults::stop_failing();
        SCOPED_TRACE(testing::Message() << failed << ", call " << n);
        if (pictures && !host.lacks) {
            EXPECT_EQ(*pictures, *whole);
        }
        if (!pictures) {
            EXPECT_FALSE(to_string(pictures.error()).empty());
        }
        if (failed.empty()) break;
        struck.insert(failed);
        host.lacks = false;
        const auto next = host.play(scene_, plants_);
        ASSERT_TRUE(next) << to_string(next.error());
        EXPECT_FALSE(host.lacks);
        EXPECT_EQ(*next, *whole);
        ASSERT_EQ(faults::live_objects(), of_host);
    }
    for (const char* call : {"vkQueueSubmit2", "vkWaitSemaphores", "vkCreateBuffer", "vkAllocateMemory"})
        EXPECT_TRUE(struck.contains(call)) << call;
}

// Whoever loads another scene while one is drawn has one of the two.
TEST_F(VulkanFaults, ASceneThatFindsNoRoomLeavesTheOneBefore) {
    const auto device = this->device();
    ASSERT_TRUE(device);
    Host host(*device);
    ASSERT_TRUE(host.create());
    ASSERT_TRUE(host.play(scene_, plants_));
    auto picture = [&] {
        std::vector<uint32_t> colors;
        EXPECT_TRUE(host.draw(3.0, ShadowKind::light_space, 2 * k_width * k_height, colors));
        return colors;
    };
    const std::vector<uint32_t> before = picture();
    Scene other = scene_;
    for (PlantPosition& position : other.positions) position.scale *= 0.5f;
    std::set<std::string> struck;
    for (uint64_t n = 0; n < k_most_calls; ++n) {
        faults::fail_nth(n, VK_ERROR_OUT_OF_DEVICE_MEMORY);
        const Status loaded = host.vegetation->set_scene(other, plants_);
        const std::string failed = faults::stop_failing();
        SCOPED_TRACE(testing::Message() << failed << ", call " << n);
        if (loaded) {
            EXPECT_TRUE(failed.empty());
            break;
        }
        struck.insert(failed);
        EXPECT_EQ(picture(), before);
    }
    EXPECT_NE(picture(), before);
    EXPECT_TRUE(struck.contains("vkAllocateMemory"));
}

// A device that is lost says so; a host may make all of it again.
TEST_F(VulkanFaults, ALostDeviceIsReportedAndMadeAgain) {
    std::vector<uint32_t> before;
    for (const char* call : {"vkQueueSubmit2", "vkWaitSemaphores", ""}) {
        {
            const auto device = this->device();
            ASSERT_TRUE(device);
            Host host(*device);
            ASSERT_TRUE(host.create());
            auto pictures = host.play(scene_, plants_);
            ASSERT_TRUE(pictures);
            if (before.empty()) before = *pictures;
            EXPECT_EQ(*pictures, before);
            bool found = false;
            for (uint64_t n = 0; *call && !found; ++n) {
                faults::fail_nth(n, VK_ERROR_DEVICE_LOST);
                const auto lost = host.play(scene_, plants_);
                const std::string failed = faults::stop_failing();
                ASSERT_FALSE(failed.empty());
                found = failed == call;
                if (!found) continue;
                ASSERT_FALSE(lost);
                EXPECT_EQ(lost.error().id, ErrorId::device_lost);
            }
        }
        EXPECT_EQ(faults::live_objects(), 0);
    }
}

}  // namespace
}  // namespace coppice
