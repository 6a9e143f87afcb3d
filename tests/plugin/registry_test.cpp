#include "runtime/plugin/registry.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include "runtime/core/jobs.h"
#include "runtime/core/log.h"

namespace coppice {
namespace {

struct Plugins : testing::Test {
    void SetUp() override {
        setenv("COPPICE_PLUGIN_PATH", "/nonexistent/folder::" TEST_PLUGIN_FOLDER, 1);
        unsetenv("UNLOADED_PLUGINS");
        set_log_sink(
            [](void* self, LogLevel level, std::string_view line) {
                static_cast<Plugins*>(self)->log += std::to_string(int(level)) + std::string(line) + "\n";
            },
            this);
    }
    void TearDown() override {
        set_log_sink(nullptr, nullptr);
        unsetenv("COPPICE_PLUGIN_PATH");
    }
    static std::string unloaded() {
        const char* text = std::getenv("UNLOADED_PLUGINS");
        return text ? text : "";
    }
    static Error error_of(const char* name) {
        Registry registry;
        Status status = registry.load(name);
        EXPECT_FALSE(status) << name;
        EXPECT_TRUE(registry.loaded().empty());
        return status ? Error{} : status.error();
    }
    std::string log;
};

TEST_F(Plugins, provide_interfaces_by_name_and_version) {
    Registry registry;
    EXPECT_EQ(registry.find<int>("test.number", 1), nullptr);
    Status status = registry.load("good");
    ASSERT_TRUE(status) << to_string(status.error());
    ASSERT_NE(registry.find<int>("test.number", 1), nullptr);
    EXPECT_EQ(*registry.find<int>("test.number", 1), 1);
    EXPECT_EQ(*registry.find<int>("test.number", 2), 2);
    EXPECT_EQ(registry.find<int>("test.number", 3), nullptr);
    EXPECT_EQ(registry.find<int>("test.other", 1), nullptr);
    EXPECT_EQ(log, "0good: is ready\n");
}

// Built against a header whose structs were shorter (tests/embedding/older).
TEST_F(Plugins, built_against_an_older_header_keep_working) {
    {
        Registry registry;
        const Status status = registry.load("older");
        ASSERT_TRUE(status) << to_string(status.error());
        ASSERT_NE(registry.find<int>("test.older", 1), nullptr);
        EXPECT_EQ(*registry.find<int>("test.older", 1), 1);
        EXPECT_EQ(log, "1older: is old\n");
    }
    EXPECT_EQ(unloaded(), "older;");
}

TEST_F(Plugins, run_jobs_on_the_hosts_threads) {
    static size_t g_counts[2];
    set_job_runner(
        [](void* counts, size_t count, size_t grain, JobBody body, void* context) {
            static_cast<size_t*>(counts)[0] = count;
            static_cast<size_t*>(counts)[1] = grain;
            body(context, 0, count);
        },
        g_counts);
    Registry registry;
    const Status status = registry.load("jobs");
    set_job_runner(nullptr, nullptr);
    ASSERT_TRUE(status) << to_string(status.error());
    EXPECT_EQ(g_counts[0], 1000u);
    EXPECT_EQ(g_counts[1], 16u);
}

TEST_F(Plugins, load_once) {
    Registry registry;
    ASSERT_TRUE(registry.load("good"));
    ASSERT_TRUE(registry.load("good"));
    EXPECT_EQ(registry.loaded(), std::vector<std::string>{"good"});
    EXPECT_EQ(log, "0good: is ready\n");
}

TEST_F(Plugins, unload_in_reverse_order) {
    {
        Registry registry;
        ASSERT_TRUE(registry.load("good"));
        ASSERT_TRUE(registry.load("dependent"));
        EXPECT_EQ(registry.loaded(), (std::vector<std::string>{"good", "dependent"}));
        EXPECT_EQ(unloaded(), "");
    }
    EXPECT_EQ(unloaded(), "dependent;good;");
}

TEST_F(Plugins, whose_load_fails_leave_nothing) {
    Registry registry;
    Status status = registry.load("fails");
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().id, ErrorId::name_unknown);
    EXPECT_NE(status.error().fault.find("42"), std::string::npos) << status.error().fault;
    EXPECT_NE(status.error().fault.find("has no tea"), std::string::npos) << status.error().fault;
    EXPECT_EQ(registry.find<int>("test.failed", 1), nullptr);
    EXPECT_TRUE(registry.loaded().empty());
    EXPECT_EQ(unloaded(), "");

    // What it missed may come: then it loads.
    EXPECT_EQ(registry.load("dependent").error().id, ErrorId::name_unknown);
    ASSERT_TRUE(registry.load("good"));
    EXPECT_TRUE(registry.load("dependent"));
}

TEST_F(Plugins, that_are_not_there_are_missed_with_the_places) {
    Error error = error_of("absent");
    EXPECT_EQ(error.id, ErrorId::file_missing);
    EXPECT_EQ(error.file, "absent.so");
    EXPECT_NE(error.fault.find("/nonexistent/folder, " TEST_PLUGIN_FOLDER), std::string::npos) << error.fault;
    EXPECT_NE(error.fault.find("/lib/coppice"), std::string::npos) << error.fault;
}

TEST_F(Plugins, that_are_none_are_refused) {
    EXPECT_EQ(error_of("no_entry").id, ErrorId::format_unknown);
    EXPECT_EQ(error_of("no_load").id, ErrorId::format_unknown);
    EXPECT_EQ(error_of("short_description").id, ErrorId::format_unknown);
    Error abi = error_of("wrong_abi");
    EXPECT_EQ(abi.id, ErrorId::format_unknown);
    EXPECT_NE(abi.fault.find("ABI " + std::to_string(COPPICE_PLUGIN_ABI + 1)), std::string::npos)
        << abi.fault;
    Error unresolved = error_of("unresolved");
    EXPECT_EQ(unresolved.id, ErrorId::file_unreadable);
    EXPECT_NE(unresolved.fault.find("a_function_nobody_has"), std::string::npos) << unresolved.fault;
    EXPECT_EQ(unloaded(), "");
}

TEST_F(Plugins, have_names_not_paths) {
    for (const char* name : {"", "../good", "a/b", "good.so"})
        EXPECT_EQ(error_of(name).id, ErrorId::name_unknown);
}

}  // namespace
}  // namespace coppice
