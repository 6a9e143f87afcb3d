// hostile_seeds FOLDER: the seeds as files, FOLDER/READER/0, 1, ..., for libFuzzer to begin with.
#include <cstdio>
#include <string>
#include "runtime/core/file.h"
#include "tests/hostile/reader.h"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "hostile_seeds FOLDER\n");
        return 2;
    }
    for (const auto& reader : coppice::hostile::readers()) {
        const auto seeds = reader.seeds();
        for (size_t i = 0; i < seeds.size(); ++i) {
            const std::string path = std::string(argv[1]) + "/" + reader.name + "/" + std::to_string(i);
            if (const auto written = coppice::write_file(path, seeds[i]); !written) {
                std::fprintf(stderr, "%s\n", coppice::to_string(written.error()).c_str());
                return 1;
            }
        }
    }
}
