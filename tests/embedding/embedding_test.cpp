// What a host does on its first day: install, find, build, run. Each program here is one of somebody else's.
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>
#include <sys/wait.h>
#include <gtest/gtest.h>
#include "tests/tools/run_program.h"

namespace fs = std::filesystem;

namespace {

struct ShellResult {
    int exit_code;
    std::string said;  // both outputs
};

ShellResult run(const std::string& folder, const std::string& command) {
    const std::string log = folder + "/log.txt";
    const int status =
        std::system(("cd '" + folder + "' && ( " + command + " ) >'" + log + "' 2>&1").c_str());
    std::ifstream file(log);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128,
            std::string(std::istreambuf_iterator<char>(file), {})};
}

const std::string k_source = COPPICE_SOURCE_DIR, k_embedding = k_source + "/tests/embedding";
const std::string k_compiler = std::string(" -DCMAKE_CXX_COMPILER='") + COPPICE_CXX + "'" +
                               " -DCMAKE_CXX_COMPILER_LAUNCHER='" + COPPICE_LAUNCHER + "' ";

struct Embedding : testing::Test {
    void SetUp() override {
        if (*COPPICE_SANITIZE) GTEST_SKIP() << "hosts are not built with this build's sanitizers";
        folder = fresh_folder();
    }
    void TearDown() override {
        if (!HasFailure() && !folder.empty()) fs::remove_all(folder);
    }
    // What is installed, at a place that nothing was told of when it was.
    std::string install() {
        const ShellResult installed =
            run(folder, std::string(COPPICE_CMAKE) + " --install '" + COPPICE_BUILD_DIR + "' --prefix '" +
                            folder + "/before' && mv before prefix");
        EXPECT_EQ(installed.exit_code, 0) << installed.said;
        return folder + "/prefix";
    }
    std::string folder;
};

// Three bytes a pixel.
struct Ppm {
    int width = 0, height = 0;
    std::string rgb;
    std::array<int, 3> at(int x, int y) const {
        const size_t i = 3 * (size_t(y) * size_t(width) + size_t(x));
        return {uint8_t(rgb[i]), uint8_t(rgb[i + 1]), uint8_t(rgb[i + 2])};
    }
    double share_of(std::array<int, 3> color, int left, int top, int right, int bottom) const {
        int count = 0;
        for (int y = top; y < bottom; ++y)
            for (int x = left; x < right; ++x) count += at(x, y) == color;
        return double(count) / ((right - left) * (bottom - top));
    }
};

Ppm read_ppm(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string magic;
    Ppm picture;
    int most = 0;
    file >> magic >> picture.width >> picture.height >> most;
    file.get();
    picture.rgb.assign(std::istreambuf_iterator<char>(file), {});
    EXPECT_EQ(magic, "P6");
    EXPECT_EQ(picture.rgb.size(), size_t(picture.width) * size_t(picture.height) * 3) << path;
    return picture;
}

// Of a board of vulkan_host: its pixels without the border, and its colour.
struct Board {
    int left, top, right, bottom;
    std::array<int, 3> color;
};
Board board(int number, int frame) {
    const double focal_px = 270.0 / std::tan(0.5 * 1.0471976), w = 6.0 * (1 << number);
    const double x = w * (0.35 * number - 0.75 + 0.01 * frame);
    const int left = 480 + int(focal_px * x / w), top = 270 - int(focal_px * 2.0 / w);
    return {left + 2,
            top + 2,
            left + int(focal_px * 1.5 / w) - 2,
            top + int(focal_px * 4.0 / w) - 2,
            {255, int(51.0 * number + 0.5), 255}};
}

}  // namespace

TEST_F(Embedding, VulkanHostFindsThePackageAndItsBoardsStandAmongPlants) {
    const std::string prefix = install();
    const ShellResult built =
        run(folder, std::string(COPPICE_CMAKE) + " -S '" + k_embedding + "/vulkan_host' -B build -G Ninja" +
                        " -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH='" + prefix + "'" + k_compiler +
                        "&& " + COPPICE_CMAKE + " --build build");
    ASSERT_EQ(built.exit_code, 0) << built.said;
    EXPECT_EQ(built.said.find("warning"), std::string::npos) << built.said;
    for (int frames : {1, 9}) {
        const ShellResult ran = run(folder, "build/vulkan_host '" + k_embedding +
                                                "/ferns.eco.json' out.ppm " + std::to_string(frames));
        ASSERT_EQ(ran.exit_code, 0) << ran.said;
        const Ppm picture = read_ppm(folder + "/out.ppm");
        ASSERT_EQ(picture.width, 960);
        // In front of all plants, the first board is what the host drew; what it moved away from is not its colour.
        const Board nearest = board(0, frames - 1);
        EXPECT_EQ(picture.share_of(nearest.color, nearest.left, nearest.top, nearest.right, nearest.bottom),
                  1.0);
        EXPECT_NE(picture.at(nearest.left - 6, nearest.top), nearest.color);
        // The others stand behind the hedge, which is lower than they are: their feet are hidden, their heads are not.
        for (int number : {1, 2}) {
            const Board seen = board(number, frames - 1);
            const int height = seen.bottom - seen.top;
            EXPECT_GT(picture.share_of(seen.color, seen.left, seen.top, seen.right, seen.top + height / 8),
                      0.9)
                << "board " << number;
            EXPECT_LT(
                picture.share_of(seen.color, seen.left, seen.bottom - height / 4, seen.right, seen.bottom),
                0.2)
                << "board " << number;
        }
        // Above hedge and boards the host's sky is as it was.
        EXPECT_EQ(picture.share_of({102, 153, 204}, 0, 0, picture.width, 20), 1.0);
    }
}

TEST_F(Embedding, AHostInCDrawsWhatOneInCppDraws) {
    const std::string prefix = install(), of_prefix = " -DCMAKE_PREFIX_PATH='" + prefix + "'",
                      scene = " '" + k_embedding + "/ferns.eco.json' ", cmake = COPPICE_CMAKE;
    const ShellResult built = run(
        folder,
        cmake + " -S '" + k_embedding + "/vulkan_host' -B cpp -G Ninja" + of_prefix + k_compiler + "&& " + cmake +
            " --build cpp && " + cmake + " -S '" + k_embedding + "/c_host' -B c -G Ninja" + of_prefix + " && " +
            cmake + " --build c && " + cmake + " -S '" + k_embedding + "/c_host' -B older -G Ninja" + of_prefix +
            " -DOLDER_HEADER='" + k_embedding + "/older/coppice.h' && " + cmake + " --build older");
    ASSERT_EQ(built.exit_code, 0) << built.said;
    ASSERT_EQ(run(folder, "cpp/vulkan_host" + scene + "cpp.ppm 1").exit_code, 0);
    const ShellResult drawn = run(folder, "c/c_host" + scene + "c.ppm");
    ASSERT_EQ(drawn.exit_code, 0) << drawn.said;
    EXPECT_NE(drawn.said.find("plants 600 models 1 "), std::string::npos) << drawn.said;
    EXPECT_NE(drawn.said.find("removed twice: 2 "), std::string::npos) << drawn.said;

    // The same but for the boards, and for what a camera's angles are rounded to.
    const Ppm cpp = read_ppm(folder + "/cpp.ppm"), c = read_ppm(folder + "/c.ppm");
    ASSERT_EQ(c.rgb.size(), cpp.rgb.size());
    int plants = 0, different = 0, compared = 0;
    for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; ++x) {
            const auto a = c.at(x, y), b = cpp.at(x, y);
            if (b[0] == 255 && b[2] == 255) continue;  // a board
            ++compared;
            plants += a != std::array<int, 3>{102, 153, 204};
            different += std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) > 24;
        }
    EXPECT_GT(plants, compared / 10);
    EXPECT_LT(different, compared / 100);

    const ShellResult older = run(folder, "older/c_host" + scene + "older.ppm");
    ASSERT_EQ(older.exit_code, 0) << older.said;
    EXPECT_EQ(older.said, drawn.said);
    EXPECT_EQ(read_ppm(folder + "/older.ppm").rgb, c.rgb);

    const ShellResult nowhere = run(folder, "c/c_host nowhere.eco.json none.ppm");
    EXPECT_EQ(nowhere.exit_code, 2);
    EXPECT_NE(nowhere.said.find("nowhere.eco.json: no such file"), std::string::npos) << nowhere.said;
}

TEST_F(Embedding, EntityHostNeedsOnlyPkgConfigAndNoVulkan) {
    const std::string prefix = install();
    const ShellResult built = run(
        folder,
        "export PKG_CONFIG_PATH='" + prefix + "/" + COPPICE_LIB_DIR + "/pkgconfig' && " + COPPICE_CXX +
            " -std=c++20 -O1 '" + k_embedding +
            "/entity_host/main.cpp' -o entity_host $(pkg-config --cflags --libs coppice-vegetation-core)" +
            " -Wl,-rpath,'" + prefix + "/" + COPPICE_LIB_DIR + "'");
    ASSERT_EQ(built.exit_code, 0) << built.said;
    const ShellResult libraries = run(folder, "ldd entity_host");
    ASSERT_NE(libraries.said.find("libcoppice_core"), std::string::npos) << libraries.said;
    for (const char* graphics : {"vulkan", "coppice_gpu", "glfw", "OpenImageIO"})
        EXPECT_EQ(libraries.said.find(graphics), std::string::npos) << libraries.said;

    const ShellResult ran = run(folder, "./entity_host '" + k_embedding + "/ferns.eco.json'");
    ASSERT_EQ(ran.exit_code, 0) << ran.said;
    std::istringstream lines(ran.said);
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "plants 600 models 1");
    std::getline(lines, line);
    unsigned plants_seen = 0;
    std::vector<double> vertices_a_plant;  // by distance
    for (unsigned from_m, plants, triangles, leaves, strokes, points;
         lines >> from_m >> plants >> triangles >> leaves >> strokes >> points;) {
        plants_seen += plants;
        vertices_a_plant.push_back((3.0 * triangles + 4.0 * leaves + 2.0 * strokes + points) / plants);
    }
    ASSERT_GE(vertices_a_plant.size(), 2u) << ran.said;
    for (size_t ring = 1; ring < vertices_a_plant.size(); ++ring)
        EXPECT_LE(vertices_a_plant[ring], vertices_a_plant[ring - 1]) << ran.said;
    EXPECT_GT(vertices_a_plant.back(), 0.0) << ran.said;
    EXPECT_LT(vertices_a_plant.back(), 0.7 * vertices_a_plant.front()) << ran.said;
    EXPECT_EQ(plants_seen, 600u) << ran.said;
    EXPECT_EQ(run(folder, "./entity_host nowhere.eco.json").exit_code, 2);
}

TEST_F(Embedding, WithTheSourcesNothingReachesTheHostsOwn) {
    const ShellResult built =
        run(folder, std::string(COPPICE_CMAKE) + " -S '" + k_embedding + "/subdirectory' -B build -G Ninja" +
                        " -DCOPPICE_SOURCE_DIR='" + k_source + "'" + k_compiler + "&& " + COPPICE_CMAKE +
                        " --build build --target subdirectory_host");
    ASSERT_EQ(built.exit_code, 0) << built.said;
    EXPECT_EQ(run(folder, "build/subdirectory_host nowhere.plant").exit_code, 2);
    const ShellResult command =
        run(folder, "grep '\"command\".*subdirectory_host.dir/main.cpp' build/compile_commands.json");
    ASSERT_EQ(command.exit_code, 0);
    // Folders to look in, the language, and what {fmt} says of itself: no option and no definition of ours.
    for (const char* leak : {" -O", " -W", " -f", "GLM_", "VK_", "COPPICE_", "nlohmann"})
        EXPECT_EQ(command.said.find(leak), std::string::npos) << leak << " in " << command.said;
    // Neither the program nor its tests are built for a host.
    EXPECT_NE(run(folder, std::string(COPPICE_CMAKE) + " --build build --target coppice").exit_code, 0);
}
