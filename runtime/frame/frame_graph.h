// The passes of a frame: each declares the buffers it reads and writes and how; barriers follow from that, and a
// timestamp section surrounds each pass. Built once, recorded every frame; a pass may be switched off for a frame and
// then costs nothing.
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
    compute_atomic,      // commutative atomics only: consecutive passes with this access need no barrier between them
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
    // The buffer may change between frames (rings): set_buffer. The contents before the frame are taken as ready.
    ResourceIndex add_buffer(const char* name, const gpu::Buffer* buffer);
    void set_buffer(ResourceIndex resource, const gpu::Buffer* buffer);

    using Record = std::function<void(VkCommandBuffer)>;
    // In order of execution. Returns the pass's index.
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
        VkPipelineStageFlags2 write_stages, read_stages;  // since the last barrier
        VkAccessFlags2 write_access;
        bool atomic;
    };
    struct Pass {
        const char* name;
        std::vector<ResourceUse> uses;
        Record record;
        bool active;
        uint32_t barriers;
    };
    std::vector<Resource> resources_;
    std::vector<Pass> passes_;
    std::vector<VkBufferMemoryBarrier2> barriers_;
};

}  // namespace coppice
