// What a user meets who mistypes: one line that says what is wrong and what would be right, and the exit
// code.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <gtest/gtest.h>
#include "tests/tools/run_program.h"

namespace {

void write(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

// One line on standard error, from us, that has `word` in it.
void expect_failure(const ProgramResult& result, int exit_code, const std::string& word) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_TRUE(result.err.starts_with("coppice: ")) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
}

const std::vector<std::string> k_subcommands{"cook", "inspect", "play", "bench", "compare", "bundle"};

}  // namespace

TEST(CommandLine, SaysItsVersion) {
    const ProgramResult result = run_coppice({"--version"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.out, "coppice " COPPICE_VERSION "\n");
}

TEST(CommandLine, HelpTeachesWithExamplesAndExitCodes) {
    const ProgramResult result = run_coppice({"--help"});
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.out.find("Examples:"), std::string::npos);
    EXPECT_NE(result.out.find("3 no usable device"), std::string::npos);
    for (const std::string& name : k_subcommands) EXPECT_NE(result.out.find(name), std::string::npos) << name;
}

TEST(CommandLine, EverySubcommandExplainsItselfByExample) {
    for (const std::string& name : k_subcommands) {
        const ProgramResult result = run_coppice({name, "--help"});
        EXPECT_EQ(result.exit_code, 0) << name;
        EXPECT_NE(result.out.find("coppice " + name + " "), std::string::npos) << result.out;
    }
}

TEST(CommandLine, NoSubcommandIsAUsageError) { expect_failure(run_coppice({}), 2, "no subcommand"); }

TEST(CommandLine, AnUnknownSubcommandNamesTheKnownOnes) {
    const ProgramResult result = run_coppice({"plya"});
    expect_failure(result, 2, "'plya'");
    for (const std::string& name : k_subcommands) EXPECT_NE(result.err.find(name), std::string::npos) << name;
}

TEST(CommandLine, AnUnknownOptionIsAUsageError) {
    expect_failure(run_coppice({"play", "x.eco.json", "--headles", "64x64"}), 2, "--headles");
}

TEST(CommandLine, AnUnknownBenchmarkNamesTheKnownOnes) {
    expect_failure(run_coppice({"bench", "speed"}), 2, "raster");
}

TEST(CommandLine, AMissingFileIsBadInput) {
    const std::string folder = fresh_folder();
    expect_failure(run_coppice({"inspect", folder + "/none.plant"}), 2, folder + "/none.plant");
    expect_failure(run_coppice({"cook", folder + "/none.glb", "-o", folder + "/a.plant"}), 2, "none.glb");
    expect_failure(run_coppice({"cook", folder + "/none.json", "-o", folder + "/a.plant"}), 2, "none.json");
    expect_failure(run_coppice({"play", folder + "/none.eco.json", "--headless", "64x64"}), 2,
                   "none.eco.json");
    EXPECT_FALSE(std::filesystem::exists(folder + "/a.plant"));
}

TEST(CommandLine, MalformedJsonIsBadInputWithItsPlace) {
    const std::string folder = fresh_folder();
    write(folder + "/broken.eco.json", "{\n  \"name\": \"x\",\n  \"plants\": [}\n");
    expect_failure(run_coppice({"play", folder + "/broken.eco.json", "--headless", "64x64"}), 2, "line 3");
    write(folder + "/broken.json", "{\n  \"name\": oak\n}\n");
    expect_failure(run_coppice({"cook", folder + "/broken.json", "-o", folder + "/a.plant"}), 2, "line 2");
    EXPECT_FALSE(std::filesystem::exists(folder + "/a.plant"));
}

TEST(CommandLine, AFileOfAnotherKindIsBadInput) {
    const std::string folder = fresh_folder();
    write(folder + "/text.plant",
          "This is no packed plant, and never was one. It is only long enough to be read.\n");
    expect_failure(run_coppice({"inspect", folder + "/text.plant"}), 2, "text.plant");
    write(folder + "/text.glb", "This is no glTF.\n");
    expect_failure(run_coppice({"cook", folder + "/text.glb", "-o", folder + "/a.plant"}), 2, "text.glb");
    expect_failure(run_coppice({"inspect", folder}), 2, folder);
}

TEST(CommandLine, APictureSizeThatCannotBeMeantIsAUsageError) {
    for (const char* size : {"640", "640x", "x480", "0x480", "640x480x3", "-640x480", "640x99999", "1e3x100"})
        expect_failure(run_coppice({"play", "x.eco.json", std::string("--headless=") + size}), 2, "1280x720");
}

TEST(CommandLine, PicturesThatCannotBeMeantAreAUsageError) {
    expect_failure(run_coppice({"play", "x.eco.json", "--headless", "64x64", "--pictures", "1,two,3"}), 2,
                   "'two'");
}

TEST(CommandLine, WithoutADisplayPlaySaysHowToGoOn) {
    const ProgramResult result =
        run_coppice({"play", "x.eco.json"}, {"DISPLAY=", "WAYLAND_DISPLAY=", "XDG_RUNTIME_DIR="});
    expect_failure(result, 2, "--headless 1280x720");
}

TEST(CommandLine, APluginThatIsNoneIsNamed) {
    const std::string folder = fresh_folder();
    write(folder + "/x.eco.json", "{}");
    write(folder + "/terrain.so", "not a shared module");
    const ProgramResult result = run_coppice({"play", folder + "/x.eco.json", "--headless", "64x64"},
                                             {"COPPICE_PLUGIN_PATH=" + folder});
    expect_failure(result, 2, folder + "/terrain.so");
}

TEST(CommandLine, AFolderThatCannotBeWrittenFailsBeforeTheWork) {
    const std::string folder = fresh_folder();
    write(folder + "/file", "in the way");
    expect_failure(run_coppice({"play", "x.eco.json", "--headless", "64x64", "--out", folder + "/file/out"}),
                   1, "--out");
}

TEST(CommandLine, ACookThatCannotWriteSaysSo) {
    const std::string folder = fresh_folder();
    write(folder + "/file", "in the way");
    const std::string birch = std::string(COPPICE_SOURCE_DIR) + "/content/species/birch.json";
    const ProgramResult result = run_coppice({"cook", birch, "-o", folder + "/file/birch.plant"});
    expect_failure(result, 1, "birch.plant");
}
