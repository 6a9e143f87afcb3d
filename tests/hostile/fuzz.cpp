// libFuzzer's entries: fuzz_NAME for each reader, which COPPICE_READER names.
#include <cstdint>
#include <cstring>
#include "tests/hostile/reader.h"

using namespace coppice::hostile;

extern "C" {

size_t LLVMFuzzerMutate(uint8_t* bytes, size_t size, size_t most_size);

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
    static const Reader* const k_reader = find_reader(COPPICE_READER);
    k_reader->read({reinterpret_cast<const std::byte*>(bytes), size});
    return 0;
}

// Mutants with wrong checksums find only the check of the checksum.
size_t LLVMFuzzerCustomMutator(uint8_t* bytes, size_t size, size_t most_size, unsigned seed) {
    size = LLVMFuzzerMutate(bytes, size, most_size);
    static const Reader* const k_reader = find_reader(COPPICE_READER);
    if (!k_reader->seal || seed % 8 == 0) return size;
    Bytes sealed(size);
    std::memcpy(sealed.data(), bytes, size);
    k_reader->seal(sealed);
    std::memcpy(bytes, sealed.data(), size);
    return size;
}
}
