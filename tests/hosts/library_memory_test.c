/* The Vulkan library takes memory, caches and threads from the host, and leaves nothing there. */
#include "library_own.h"

TEST_WITH(vulkan_uses_memory_cache_and_threads_of_the_host, NULL, is_silent)
{
    static uint8_t wanted[TRAIL_BYTES], found[TRAIL_BYTES];
    const VkPipelineCacheCreateInfo cache = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    assert_int_equal(vkCreatePipelineCache(vk.device, &cache, NULL, &own.cache), VK_SUCCESS);
    vulkan_draw(&vk_scene, wanted);
    struct dt_vk_host host = own_host();
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    assert_true(rt && dt_vk_import_scene(rt, &vk_scene));
    own.fail_pipelines = true;
    REFUSED(dt_vk_create(rt, &features_vk), "Pipelines(");
    own.fail_pipelines = false;
    own.pipelines = 0;
    assert_true(dt_vk_create(rt, &features_vk));
    assert_int_equal(own.pipelines, FEATURES_PASSES);
    own.fail_memory = 3;
    REFUSED(dt_vk_resize(rt, WIDTH, HEIGHT), "): VK_ERROR_OUT_OF_DEVICE_MEMORY: use ");
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT));
    run_frames(rt, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    assert_true(vk.blocks > FEATURES_PASSES && own.memory > 1);

    struct dt_vk_runtime *other =
        dt_vk_open(&host); /* shares all programs, and outlives the first */
    assert_true(other && dt_vk_import_scene(other, &vk_scene) && dt_vk_create_from(other, rt) &&
                dt_vk_resize(other, WIDTH, HEIGHT));
    assert_int_equal(own.pipelines, FEATURES_PASSES);
    assert_int_equal(own.strangers, 0);
    dt_vk_close(rt);
    run_frames(other, found);
    assert_memory_equal(wanted, found, TRAIL_BYTES);
    dt_vk_close(other);
    assert_int_equal(vk.blocks, 0);
    assert_int_equal(own.memory, 0);
    vkDestroyPipelineCache(vk.device, own.cache, NULL);
    own.cache = VK_NULL_HANDLE;
}

TEST_WITH(vulkan_tells_what_cannot_be_shared, NULL, is_silent)
{
    struct dt_vk_host host = vk_host(), other = vk_host();
    struct dt_vk_runtime *rt = open_features(), *bare = dt_vk_open(&host);
    REFUSED(dt_vk_create_from(rt, bare), "create_from: the other runtime has no pipeline");
    REFUSED(dt_vk_create_from(rt, rt), "create_from: the other runtime has no pipeline");
    other.callbacks = &vk.callbacks;
    struct dt_vk_runtime *careful = dt_vk_open(&other);
    REFUSED(dt_vk_create_from(careful, rt), "create_from: the runtimes have different devices");
    other.allocator.allocate = own_allocate;
    REFUSED(dt_vk_open(&other), "only one of allocate and free");
    dt_vk_close(careful);
    dt_vk_close(bare);
    dt_vk_close(rt);
    assert_int_equal(vk.blocks, 0);
}

RUN_TESTS("memory", open_vulkan, close_vulkan)
