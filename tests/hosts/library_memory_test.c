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

    assert_int_equal(own.strangers, 0);
    dt_vk_close(rt);
    assert_int_equal(vk.blocks, 0);
    assert_int_equal(own.memory, 0);
    vkDestroyPipelineCache(vk.device, own.cache, NULL);
    own.cache = VK_NULL_HANDLE;
}

TEST_WITH(vulkan_needs_both_of_an_allocator, NULL, is_silent)
{
    struct dt_vk_host host = vk_host();
    host.allocator.allocate = own_allocate;
    REFUSED(dt_vk_open(&host), "only one of allocate and free");
}

RUN_TESTS("memory", open_vulkan, close_vulkan)
