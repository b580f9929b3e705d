/* What an open device consists of. Private to this room (and to its tests). */
#ifndef HEWN_SRC_GPU_DEVICE_H
#define HEWN_SRC_GPU_DEVICE_H

#include "gpu/cache.h"
#include "gpu/commands.h"
#include "gpu/instance.h"

enum {
    HEWN_MARKS_MAX = 64, /* marks of one recording */
    HEWN_PUSH_MAX = 128  /* bytes of push constants that every device has */
};

/* A descriptor set of the one layout that Hewn has: a uniform buffer at binding 0. */
typedef struct hewn_uniform_set {
    VkDescriptorSet handle;
    VkBuffer buffer; /* what it points to in the present recording */
} hewn_uniform_set;

typedef struct hewn_ahead hewn_ahead;

struct hewn_commands {
    hewn_device *device;
    VkCommandPool pool;
    VkCommandBuffer buffer;
    VkFence fence;
    VkQueryPool queries; /* none where the queue has no timestamps */
    bool open;
    bool wrote; /* something is recorded that the next operation must wait for */
    uint32_t marks;
    hewn_result failure; /* the first failure of this recording */
    hewn_error reason;
    VkDescriptorPool *pools;
    size_t pool_count, pool_capacity;
    hewn_uniform_set *sets;
    size_t set_count, set_capacity, sets_used;
};

struct hewn_device {
    hewn_instance instance;
    hewn_messages messages;
    hewn_device_info info;
    VkPhysicalDevice physical;
    VkDevice handle;
    bool opened; /* `vk` is complete */
    VkQueue queue;
    uint32_t queue_family;
    uint32_t timestamp_bits;     /* 0: the queue has no timestamps */
    double timestamp_seconds;    /* one tick */
    uint32_t max_group_count[3]; /* workgroups of one dispatch */
    uint64_t max_uniform_range;  /* bytes */
    uint32_t subgroup_size;      /* invocations; 0 where compute shaders cannot vote and shuffle */
    VkPhysicalDeviceMemoryProperties memory;
    hewn_vulkan_device_table vk;
    VkDescriptorSetLayout uniform_layout;
    VkPipelineCache pipeline_cache;
    size_t pipeline_cache_bytes; /* as the driver counted them when the cache was new */
    hewn_hash pipeline_key;
    VkPipelineCacheHeaderVersionOne pipeline_header; /* how the driver's data must begin */
    hewn_cache cache;
    bool compiles_late; /* the driver writes machine code when work first arrives, see ahead.h */
    hewn_ahead *ahead;  /* NULL where no program waits for code */
    uint64_t bytes, peak_bytes;
    uint64_t most_bytes;    /* no more may be in use; 0: no limit */
    uint64_t refused_bytes; /* what the last buffer would have brought it to that was refused for that; 0: none was */
    struct hewn_commands commands; /* the one recording, used again and again */
};

/* The parts of a device that commands.c owns. */
hewn_result hewn_commands_setup(hewn_device *device, hewn_error *error);
void hewn_commands_teardown(hewn_device *device);

/* Remembers a failure of recording for the submit; the first one stays. */
void hewn_commands_fail(hewn_commands *commands, hewn_result code, const char *format, ...) HEWN_PRINTF(3, 4);

struct hewn_program {
    VkPipelineLayout layout;
    VkPipeline pipeline;
    uint32_t push_bytes;
    bool uniforms;
};

/* A program's layout and pipeline, into a struct whose other members are set; after a failure too it is to be unmade.
 * These two take nothing from Hewn's heap. */
hewn_result hewn_program_make(hewn_device *device, const char *name, hewn_program *program, const uint32_t *words,
                              size_t bytes, hewn_error *error);
void hewn_program_unmake(hewn_device *device, hewn_program *program);

/* A second Vulkan device on the same instance with what it takes to make programs, and nothing else: no caches, no
 * recording. After a failure too it is to be closed. Another thread may do this, and use it. */
hewn_result hewn_device_open_second(const hewn_device *device, hewn_device *out, hewn_error *error);
void hewn_device_close_second(hewn_device *second);

/* The one descriptor layout. */
hewn_result hewn_programs_describe(hewn_device *device, hewn_error *error);

/* The parts that program.c owns: the descriptor layout and the pipeline cache (saved when it grew). */
hewn_result hewn_programs_setup(hewn_device *device, hewn_error *error);
void hewn_programs_teardown(hewn_device *device);

/* Physical devices with their descriptions, best first (physical.c). Both arrays are owned by the caller. */
hewn_result hewn_physical_list(const hewn_instance *instance, VkPhysicalDevice **handles, hewn_device_info **infos,
                               size_t *count, hewn_error *error);

#endif
