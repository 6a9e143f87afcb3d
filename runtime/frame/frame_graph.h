// The passes of a frame: each declares the buffers it reads and writes and how; barriers follow from that,
// and a timestamp section surrounds each pass. Built once, recorded every frame; a pass may be switched off
// for a frame and then costs nothing.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>
#include "runtime/gpu/buffer.h"
#include "runtime/gpu/commands.h"

namespace coppice {

enum class BufferAccess {
    compute_read,        // storage or texel buffer
    compute_write,       // written completely or in part, no reading
    compute_read_write,  // also atomics; passes that only add by atomics to one buffer still are ordered
    compute_atomic,  // commutative atomics only: consecutive passes with this access need no barrier between
                     // them
    transfer_read,
    transfer_write,
    indirect_read,
    host_read,  // after the frame, through mapped memory
};

using ResourceIndex = uint32_t;

struct ResourceUse {
    ResourceIndex resource;
    BufferAccess access;
};

class FrameGraph {
  public:
    // The buffer may change between frames (rings): set_buffer. Contents that were there before the first
    // frame are taken as ready; frames are ordered among themselves, as recorded. `buffer` is kept for the
    // passes only.
    ResourceIndex add_buffer(const char* name, const gpu::Buffer* buffer);
    void set_buffer(ResourceIndex resource, const gpu::Buffer* buffer);
    const gpu::Buffer* buffer(ResourceIndex resource) const;

    using Record = std::function<void(VkCommandBuffer)>;
    // In order of execution. Returns the pass's index. record may be empty. Barriers lie between passes: a
    // pass of several commands on one buffer orders those itself.
    uint32_t add_pass(const char* name, std::vector<ResourceUse> uses, Record record);
    void set_active(uint32_t pass, bool active);

    // Records all active passes with their barriers; timestamps may be null. Allocates nothing.
    void record(VkCommandBuffer commands, gpu::Timestamps* timestamps);

    // One line a pass with its reads, writes and barriers of the last recording: for people.
    std::string describe() const;

  private:
    struct Resource {
        const char* name;
        const gpu::Buffer* buffer;
        VkPipelineStageFlags2 write_stages, read_stages;  // of the last write, and of the reads after it
        VkAccessFlags2 write_access;
        VkPipelineStageFlags2 seen_stages;  // where barriers have made the last write visible
        VkAccessFlags2 seen_access;
        VkPipelineStageFlags2 after_reads_stages;  // where barriers have made later work wait for the reads
        bool atomic;                               // the last use was compute_atomic
    };
    struct Pass {
        const char* name;
        std::vector<ResourceUse> uses;
        Record record;
        bool active;
        VkMemoryBarrier2 barrier;  // before it, in the last recording; no stages: none
    };
    void require(const ResourceUse& use, VkMemoryBarrier2& barrier) const;
    void note(const Pass& pass);
    void emit(VkCommandBuffer commands, const VkMemoryBarrier2& barrier);

    std::vector<Resource> resources_;
    std::vector<Pass> passes_;
};

}  // namespace coppice
