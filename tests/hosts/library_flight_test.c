/* Frames in flight and parts of frames: the Vulkan library waits for the host's work and for nothing
 * else, and validation, which also checks between command buffers here, hears when it does not. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layouts.h"
#include "library_own.h"

/* Like open_vulkan, but validation checks for hazards between command buffers, too. */
static int open_vulkan_for_flight(void **state)
{
    setenv("VK_LAYER_ENABLES",
           "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
           "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
           1);
    return open_vulkan(state);
}

enum { CYCLES = 10 };

/* The value that the host writes into its image before a frame. Below: the place for the frame's
 * copy, one for each frame in flight. */
static float written_before(uint32_t frame)
{
    return 0.125f * (float)(frame % 4);
}
static VkDeviceSize copy_of(uint32_t frame)
{
    return GEOMETRY_BYTES / 2 + (VkDeviceSize)(frame % IN_FLIGHT) * TRAIL_BYTES;
}

/* The host records no barriers but those for its own changes of layout. */
static void write_image(VkCommandBuffer commands, VkImage image, VkImageLayout layout, float value)
{
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue color = {.float32 = {value, value, value, value}};
    move_image(commands, image, layout, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdClearColorImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &color, 1, &all);
}

/* Records a frame whose trail starts from the host's image. */
static void record_own_trail(struct dt_vk_runtime *rt, VkImage image, uint32_t frame)
{
    const struct dt_frame block = frame_of(0);
    VkCommandBuffer commands = begin_commands(&vk, frame, 0);
    write_image(commands, image,
                frame ? VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
                written_before(frame));
    assert_true(dt_vk_record(rt, commands, &block, NULL));
    copy_image(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, copy_of(frame));
}

/* The trail mixes the value that the host wrote with the newest picture, by the default weight of
 * 0.25. The picture is the same in every frame. */
static void check_trail(uint32_t frame, float first[TRAIL_BYTES / 4])
{
    const float *found = (const float *)((const char *)geometry.bytes + copy_of(frame));
    if (frame == 0)
        memcpy(first, found, TRAIL_BYTES);
    for (int i = 0; i < TRAIL_BYTES / 4; i++)
        if (fabsf(found[i] - first[i] - 0.75f * (written_before(frame) - written_before(0))) >
            1e-5f)
            fail_msg("frame %u, float %d is %g", frame, i, (double)found[i]);
}

static void import_trail(struct dt_vk_runtime *rt, const struct own_image *image)
{
    struct dt_vk_image import =
        import_of(image, VK_FORMAT_R32G32B32A32_SFLOAT, VK_IMAGE_USAGE_STORAGE_BIT, WIDTH);
    import.layout_before = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_TRAIL, &import));
}

/* Imports the output, and leaves it ready for a copy, as hosts do. Across command buffers, the
 * validation layers of 1.3.239 do not see that a change of layout waits for a write through another
 * barrier (their issue 6508). The layers would complain about an output that no command reads. */
static struct own_image import_output(struct dt_vk_runtime *rt, uint32_t width)
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    const struct own_image output =
        make_image(VK_FORMAT_R8G8B8A8_UNORM, (VkExtent3D){width, HEIGHT, 1}, 1, usage);
    const struct dt_vk_image import = import_of(&output, VK_FORMAT_R8G8B8A8_UNORM, usage, width);
    assert_true(dt_vk_import_image(rt, FEATURES_RESOURCE_SHOWN, &import));
    return output;
}

static bool vulkan_records_passes(uint32_t first, uint32_t end)
{
    const struct dt_frame frame = frame_of(0);
    return dt_vk_record_passes(outside.rt, outside.commands, first ? NULL : &frame, NULL, first,
                               end);
}

/* Records the two passes. With `clears`, the host clears the second pass's input between them, and
 * the second pass goes into a command buffer of its own. */
static void paint_between(bool clears, VkDeviceSize offset)
{
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue one = {.float32 = {1, 1, 1, 1}};
    struct dt_vk_resource blurred = {0}, picture = {0};
    assert_true(vulkan_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    REFUSED(dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture),
            "resource picture: a later part of this frame writes it");
    if (clears) {
        move_image(outside.commands, blurred.image, blurred.layout,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        vkCmdClearColorImage(outside.commands, blurred.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                             &one, 1, &all);
        move_image(outside.commands, blurred.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   blurred.layout);
        submit_commands(outside.commands);
        outside.commands = new_commands();
    }
    assert_true(vulkan_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES) &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_PICTURE, &picture));
    copy_image(outside.commands, picture.image, picture.layout, offset);
}

TEST_WITH(vulkan_records_parts, NULL, is_silent)
{
    enum { FIRST = GEOMETRY_BYTES / 2, SECOND = FIRST + 4 * WIDTH * HEIGHT };
    outside.rt = open_vk_runtime(vk_host(), NULL);
    REFUSED(vulkan_records_passes(0, 1), "record_passes: call resize first");
    assert_true(dt_vk_create(outside.rt, &outside_vk) && dt_vk_resize(outside.rt, WIDTH, HEIGHT));
    outside.commands = new_commands();
    write_for_blurred(vulkan_writes);
    REFUSED(vulkan_records_passes(1, 2), "begins with pass 1, but the frame goes on with pass 0");
    REFUSED(vulkan_records_passes(0, 3), "passes 0 to 3, but the pipeline has 2");
    REFUSED(vulkan_records_passes(0, 0), "a part at least one");
    paint_between(false, FIRST);
    paint_between(true, SECOND);
    assert_true(vulkan_records_passes(0, 1));
    REFUSED(vulkan_records(),
            "record: begins with pass 0, but the frame goes on with pass 1, grade");
    finish_commands(outside.commands);
    is_painted((const uint8_t *)geometry.bytes + FIRST, black);
    is_painted((const uint8_t *)geometry.bytes + SECOND, white);
    assert_true(dt_vk_resize(outside.rt, WIDTH, HEIGHT)); /* abandons the frame */
    outside.commands = new_commands();
    write_for_blurred(vulkan_writes);
    assert_true(vulkan_records());
    dt_vk_close(outside.rt);
}

/* Each frame in flight has its own live parameters, as a buffer of the host shows, and its own
 * times. A frame waits only for the frame before the last. */
TEST_WITH(vulkan_tells_frames_in_flight_apart, NULL, is_silent)
{
    enum { SEEN = GEOMETRY_BYTES / 4, COPIES = GEOMETRY_BYTES / 2 };
    struct dt_vk_host host = vk_host();
    double ms[LAYOUTS_PASSES];
    const struct dt_vk_range seen = {geometry.handle, SEEN, sizeof(struct layouts_Seen)};
    struct layouts_live live = layouts_live_defaults;
    host.timing = true;
    host.frames = 17;
    struct dt_vk_runtime *rt = dt_vk_open(&host);
    REFUSED(dt_vk_create(rt, &layouts_vk), "opened for 17 frames in flight; use at most 16");
    dt_vk_close(rt);
    host.frames = IN_FLIGHT;
    rt = dt_vk_open(&host);
    assert_true(dt_vk_create(rt, &layouts_vk) &&
                dt_vk_import_buffer(rt, LAYOUTS_RESOURCE_SEEN, &seen) &&
                dt_vk_resize(rt, WIDTH, HEIGHT));
    for (uint32_t frame = 0; frame < CYCLES; frame++) {
        const VkBufferCopy copy = {SEEN, COPIES + frame * sizeof live.gain, sizeof live.gain};
        const struct dt_frame block = frame_of(frame);
        begin_frame(&vk, frame);
        VkCommandBuffer commands = begin_commands(&vk, frame, 0);
        if (frame == 1)
            REFUSED(dt_vk_timings(rt, 1, ms), "timings: none of the frame 1 before the last");
        if (frame > 1) {
            assert_true(dt_vk_timings(rt, 1, ms));
            assert_true(ms[0] > 0 && ms[0] < 1e5 && ms[1] > 0 && ms[1] < 1e5);
        }
        live.gain = (float)frame;
        assert_true(dt_vk_record(rt, commands, &block, &live));
        vkCmdCopyBuffer(commands, geometry.handle, geometry.handle, 1, &copy);
        end_frame(&vk, frame, 1);
    }
    REFUSED(dt_vk_timings(rt, IN_FLIGHT, ms), "up to the 2 that the runtime was opened for");
    wait_for_frames(&vk);
    for (uint32_t frame = 0; frame < CYCLES; frame++)
        assert_true(((const float *)((const char *)geometry.bytes + COPIES))[frame] ==
                    (float)frame);
    dt_vk_close(rt);
}

/* Between two passes the host clears the image that the first writes and the second reads, without
 * a barrier of its own. `drop`: the barrier to leave out. *seam: number of the last barrier before
 * the host's command. Returns whether validation reports a hazard. */
static bool clear_at_seam(unsigned drop, unsigned *seam)
{
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    const VkClearColorValue one = {.float32 = {1, 1, 1, 1}};
    struct dt_vk_resource blurred = {0};
    heard.validation = 0;
    outside.rt = open_vk_runtime(own_host(), &outside_vk);
    outside.commands = new_commands();
    write_for_blurred(vulkan_writes);
    own.barriers = 0;
    own.drop = drop;
    assert_true(vulkan_records_passes(0, OUTSIDE_PASS_GRADE_PICTURE) &&
                dt_vk_get_resource(outside.rt, OUTSIDE_RESOURCE_BLURRED, &blurred));
    assert_int_equal(blurred.layout, VK_IMAGE_LAYOUT_GENERAL);
    *seam = own.barriers;
    vkCmdClearColorImage(outside.commands, blurred.image, blurred.layout, &one, 1, &all);
    assert_true(vulkan_records_passes(OUTSIDE_PASS_GRADE_PICTURE, OUTSIDE_PASSES));
    own.drop = 0;
    finish_commands(outside.commands);
    dt_vk_close(outside.rt);
    return heard.validation;
}

/* Validation is silent with all barriers. It reports a hazard without the last barrier before the
 * host's command, or without the first one after it. */
TEST_WITH(vulkan_waits_at_seams, NULL, is_silent)
{
    unsigned seam, ignored;
    assert_false(clear_at_seam(0, &seam));
    assert_true(clear_at_seam(seam, &ignored));
    assert_non_null(strstr(heard.hazard, "SYNC-HAZARD-WRITE-AFTER-WRITE"));
    assert_true(clear_at_seam(seam + 1, &ignored));
    assert_non_null(strstr(heard.hazard, "SYNC-HAZARD"));
    heard.validation = 0;
}

/* Two pipelines, each with two frames in flight. The host writes an image of the first pipeline
 * before every frame and reads it after the frame. */
static void run_in_flight(const struct dt_shaders *shaders)
{
    static float first[TRAIL_BYTES / 4];
    const struct own_image trail =
        make_image(VK_FORMAT_R32G32B32A32_SFLOAT, (VkExtent3D){WIDTH, HEIGHT, 1}, 1,
                   VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                       VK_IMAGE_USAGE_TRANSFER_DST_BIT);
    struct dt_vk_runtime *rt = open_features(), *other = open_features();
    assert_true(dt_vk_create(rt, shaders));
    import_trail(rt, &trail);
    const struct own_image output = import_output(rt, WIDTH),
                           other_output = import_output(other, 2 * WIDTH);
    assert_true(dt_vk_resize(rt, WIDTH, HEIGHT) && dt_vk_resize(other, 2 * WIDTH, HEIGHT));
    for (uint32_t frame = 0; frame < CYCLES; frame++) {
        const struct dt_frame block = frame_of(frame);
        begin_frame(&vk, frame);
        if (frame >= IN_FLIGHT)
            check_trail(frame - IN_FLIGHT, first);
        record_own_trail(rt, trail.image, frame);
        assert_true(dt_vk_record(other, begin_commands(&vk, frame, 1), &block, NULL));
        end_frame(&vk, frame, 2);
    }
    wait_for_frames(&vk);
    for (uint32_t frame = CYCLES - IN_FLIGHT; frame < CYCLES; frame++)
        check_trail(frame, first);
    dt_vk_close(rt);
    dt_vk_close(other);
    destroy_image(&trail);
    destroy_image(&output);
    destroy_image(&other_output);
}

TEST_WITH(vulkan_keeps_frames_in_flight_apart, NULL, is_silent)
{
    run_in_flight(&features_vk);
}

/* Checks that validation can fail, since its silence means nothing otherwise. First uses wait for
 * nothing here, not even for the barrier at the start of a frame. */
static const struct dt_verbs *verbs_below;

static bool barriers_without_stages(void *runtime, uint32_t pass, const struct dt_barrier *barriers,
                                    uint32_t count)
{
    struct dt_barrier changed[DT_MAX_BINDINGS];
    for (uint32_t i = 0; i < count; i++) {
        changed[i] = barriers[i];
        if (!changed[i].from)
            changed[i].from_stages = 0;
    }
    return verbs_below->barriers(runtime, pass, changed, count);
}

static bool record_without_stages(const struct dt_recording *r)
{
    struct dt_verbs verbs = *r->verbs;
    struct dt_recording changed = *r;
    verbs_below = r->verbs;
    verbs.barriers = barriers_without_stages;
    changed.verbs = &verbs;
    return features_panel.record(&changed);
}

TEST_WITH(vulkan_hears_first_uses_that_do_not_wait, NULL, is_silent)
{
    struct dt_panel panel = features_panel;
    const struct dt_shaders hasty = {"vk", &panel, features_vk.stages};
    panel.record = record_without_stages;
    assert_int_equal(heard.validation, 0);
    run_in_flight(&hasty);
    assert_true(heard.validation > 0);
    assert_non_null(strstr(heard.hazard, "SYNC-HAZARD"));
    heard.validation = 0;
}

RUN_TESTS("in flight", open_vulkan_for_flight, close_vulkan)
