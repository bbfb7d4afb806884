/* SPDX-License-Identifier: Apache-2.0 */
/* Neighbour lists, compared with a test of all pairs. */
#include "physics.h"
#include "sim/engine/engine_core.h"
#include "suite.h"

enum { HEAP = 100 };

static struct world_object heap[HEAP];
static size_t
    pairs_near; /* near pairs that a test has met; none would mean that it tests nothing */

/* Robots among pucks, a long bar and walls.  Some stand at the edge of the world. */
static struct engine *start_a_crowd(void)
{
    physics_clear();
    physics_fence(3);
    physics_wall(1, 1, 0.3, 0.05)->pose.heading_rad = 0.7;
    for (int k = 0; k < 8; k++) {
        physics_robot(-2.4 + 0.7 * k, k % 2 ? -2 : -1.2, 45 * k);
    }
    for (int k = 0; k < 10; k++) {
        physics_object(-2.7 + 0.6 * k, 0.3, 0.1)->shape.kind = k % 2 ? WORLD_DISC : WORLD_BOX;
    }
    physics_objects[9].shape.half_y_m = 0.8;
    return physics_start(1);
}

static bool is_pair(const struct engine_pair *pair, uint32_t part, uint32_t other, bool stands)
{
    return pair->part == part && pair->other == other && pair->stands == stands;
}

/*
 * Compares the list of a part with all parts near it: each must be listed, in order.
 * @return how many are missing
 */
static size_t count_missed(struct engine *e, uint32_t part)
{
    size_t count;
    size_t next = 0;
    size_t missed = 0;
    const struct engine_pair *pairs = neighbours_of(e, part, &count);
    size_t standing = e->world->shape_count;
    for (uint32_t k = 0; k < standing + e->part_count; k++) {
        bool stands = k < standing;
        uint32_t other = stands ? k : k - (uint32_t)standing;
        const struct solid *solid = stands ? &e->shapes[other] : &e->outlines[other];
        if ((!stands && other <= part) || solid->away || !neighbours_are_near(e, part, solid)) {
            continue;
        }
        pairs_near++;
        size_t at = next;
        while (at < count && !is_pair(&pairs[at], part, other, stands)) {
            at++;
        }
        missed += at == count;
        next = at < count ? at + 1 : next;
    }
    return missed;
}

static size_t count_all_missed(struct engine *e)
{
    size_t missed = 0;
    neighbours_watch(e);
    for (uint32_t p = 0; p < e->part_count; p++) {
        missed += count_missed(e, p);
    }
    return missed;
}

static void test_all_that_is_near_is_listed_while_they_move(void)
{
    struct engine *e = start_a_crowd();
    size_t missed = 0;
    pairs_near = 0;
    for (unsigned k = 0; k < 200; k++) {
        for (size_t i = 0; i < e->robot_count; i++) {
            physics_drive(e, i, 0.5, (double)((k / 7 + i) % 5) * 0.7 - 1.4);
        }
        engine_step(e);
        missed += count_all_missed(e);
    }
    CU_ASSERT_EQUAL(missed, 0);
    CU_ASSERT(pairs_near > 200);
    engine_close(e);
}

static void test_what_turns_on_the_spot_is_listed(void)
{
    struct engine *e = start_a_crowd();
    size_t missed = 0;
    for (int k = 0; k < 90; k++) {
        struct world_pose pose = {1.2, -0.5, k * M_PI / 45};
        motion_put(e, e->robot_count + 9, pose);
        e->grid_is_old = true;
        missed += count_all_missed(e);
    }
    CU_ASSERT_EQUAL(missed, 0);
    engine_close(e);
}

static void test_lists_are_kept_while_nothing_moves_far(void)
{
    struct engine *e = start_a_crowd();
    neighbours_watch(e);
    double was = e->neighbours.marks[0].place.x;
    e->outlines[0].x += 0.05;
    neighbours_watch(e);
    CU_ASSERT_EQUAL(e->neighbours.marks[0].place.x, was);
    e->outlines[0].x += 0.05;
    neighbours_watch(e);
    CU_ASSERT_NOT_EQUAL(e->neighbours.marks[0].place.x, was);
    engine_close(e);
}

/* A pair is listed after both parts have moved apart from their marks; then they approach. */
static void test_a_list_that_is_asked_for_late(void)
{
    physics_clear();
    physics_object(0, 0, 0.1);
    physics_object(0.42, 0, 0.1);
    struct engine *e = physics_start(1);
    size_t count;
    neighbours_watch(e);
    for (int k = 0; k < 2; k++) {
        double way = k ? -0.136 : 0.068;
        e->outlines[0].x -= way;
        e->outlines[1].x += way;
        e->grid_is_old = true;
        neighbours_watch(e);
        CU_ASSERT_EQUAL(e->neighbours.lists[0].is_there, k == 1);
        (void)neighbours_of(e, 0, &count);
    }
    pairs_near = 0;
    CU_ASSERT_EQUAL(count_missed(e, 0), 0);
    CU_ASSERT_EQUAL(pairs_near, 1);
    engine_close(e);
}

/* The lists have no room for all pairs: the others are found without a list. */
static void test_a_heap_that_is_too_dense_for_the_lists(void)
{
    physics_clear();
    physics_fence(3);
    struct world_object *puck = physics_object(0, 0, 0.05);
    for (int k = 0; k < HEAP; k++) {
        heap[k] = *puck;
        heap[k].shape.pose.x_m = 0.01 * (k % 10);
        heap[k].shape.pose.y_m = 0.01 * (k / 10);
    }
    physics_world.objects = heap;
    physics_world.object_count = HEAP;
    struct engine *e = physics_start(1);
    pairs_near = 0;
    CU_ASSERT_EQUAL(count_all_missed(e), 0);
    CU_ASSERT_EQUAL(pairs_near, HEAP * (HEAP - 1) / 2);
    CU_ASSERT_TRUE(e->neighbours.lists[0].is_there);
    CU_ASSERT_FALSE(e->neighbours.lists[HEAP / 2].is_there);
    CU_ASSERT(e->neighbours.pairs_used <= e->neighbours.pairs_max);
    engine_close(e);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"all that is near is listed", test_all_that_is_near_is_listed_while_they_move},
        {"what turns on the spot", test_what_turns_on_the_spot_is_listed},
        {"lists are kept for a while", test_lists_are_kept_while_nothing_moves_far},
        {"a list that is asked for late", test_a_list_that_is_asked_for_late},
        {"a heap too dense for the lists", test_a_heap_that_is_too_dense_for_the_lists},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/neighbours", tests);
}
