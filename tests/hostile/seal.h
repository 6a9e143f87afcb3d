// Checksums of the packed formats, set to what the bytes have now.
#pragma once
#include <cstdint>
#include "tests/hostile/reader.h"

namespace coppice::hostile {

// Of what lies in the file; 0 where nothing does.
uint64_t hash_range(const Bytes& bytes, uint64_t offset, uint64_t count);

void seal_plant(Bytes& bytes);
void seal_placed(Bytes& bytes);
void seal_tiles(Bytes& bytes);
void seal_ground(Bytes& bytes);
void seal_journal(Bytes& bytes);

}  // namespace coppice::hostile
