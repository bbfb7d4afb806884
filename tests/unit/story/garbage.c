/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Damaged recordings of a run: whatever the wounds, what `muster verify`, `muster why` and the
 * page's slider ask of one is answered, and ends.  The wounds are in the file and, where its
 * checksums are mended, in the samples.  From another seed where MUSTER_SEED names one, and so many
 * times as MUSTER_ROUNDS says: make soak-strangers.
 */
#include "rich_recording.h"
#include "story/story.h"
#include "suite.h"

enum { ROUNDS = 1500, STALLS_MAX = 4 };

static struct rich_recording rich;
static struct recording whole, other;

/* Memory for the longest file that a round may have. */
static void test_the_sample_itself(void)
{
    struct mu_fault fault;
    CU_ASSERT_FATAL(rich_recording_make(&rich));
    CU_ASSERT_FATAL(rich_put(&rich, rich.wounded, sizeof rich.wounded));
    CU_ASSERT_EQUAL_FATAL(recording_create(&whole, rich.path, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_create(&other, rich.path, &fault), MU_OK);
    CU_ASSERT_FATAL(rich_put(&rich, rich.bytes, rich.len));
    CU_ASSERT_EQUAL_FATAL(recording_open(&whole, rich.path, &fault), MU_OK);
    CU_ASSERT_EQUAL(whole.steps_count, RICH_STEPS);
    CU_ASSERT_EQUAL(whole.malformed, 0);
}

/* --- questions -------------------------------------------------------------------------------- */

static uint32_t robot_ask(struct recording *r, const char *name, struct mu_text *out)
{
    struct stall stalls[STALLS_MAX];
    struct why why = {
        .minds = r->minds, .interventions = r->interventions, .step_s = 0.1, .out = out};
    uint32_t ends = 0;
    uint32_t robot = stalls_robot(r, name);
    int32_t mind = minds_robot(r->minds, name);
    if (robot != MU_NONE) {
        size_t count = stalls_find(r, robot, stalls, STALLS_MAX);
        (void)stalls_at(stalls, count < STALLS_MAX ? count : STALLS_MAX, 5);
    }
    for (uint32_t step = 0; mind != MINDS_NONE && step <= RICH_STEPS; step += 3) {
        ends |= why_speed(&why, mind, step);
        ends |= why_fact(&why, mind, step, 10 * step);
        int32_t line = minds_at(r->minds, mind, step);
        for (int32_t fact = minds_next_fact(r->minds, line, MINDS_NONE); fact != MINDS_NONE;
             fact = minds_next_fact(r->minds, line, fact)) {
            size_t bytes;
            ends += minds_text(r->minds, fact, &bytes)[0] == 'x';
        }
    }
    return ends;
}

/* @return how many steps there are */
static size_t all_ask(struct recording *r)
{
    static char bytes[65536];
    struct mu_text out;
    struct difference d;
    mu_text_init(&out, bytes, sizeof bytes);
    uint32_t ends = robot_ask(r, "red", &out) | robot_ask(r, "blue", &out);
    for (double time_s = 0; time_s < 2; time_s += 0.3) {
        int64_t step = recording_step_at(r, time_s);
        const muster_Frame *f = recording_frame(r, step);
        CU_ASSERT(!f || f->step == step);
        recording_seek(r, step - 3);
        (void)recording_next(r);
    }
    bool differs = differ_find(&whole, r, &d);
    CU_ASSERT(differs || r->steps_count == RICH_STEPS || !mcap_reader_whole(r->reader));
    CU_ASSERT(!differs || d.what[0]);
    return r->steps_count + (ends > 1u << 31);
}

static void test_wounded_runs(void)
{
    struct mu_random random;
    struct mu_fault fault;
    uint64_t seed = suite_setting("MUSTER_SEED", 41);
    uint64_t rounds = suite_setting("MUSTER_ROUNDS", ROUNDS);
    uint64_t refused = 0, fewer = 0, malformed = 0;
    mu_random_seed(&random, seed, "wounded runs");
    printf("seed %llu ", (unsigned long long)seed);
    for (uint64_t round = 0; round < rounds; round++) {
        CU_ASSERT_FATAL(rich_recording_wound(&rich, &random));
        if (recording_open(&other, rich.path, &fault) != MU_OK) {
            CU_ASSERT_NOT_EQUAL(fault.text[0], '\0');
            refused++;
            continue;
        }
        fewer += all_ask(&other) < RICH_STEPS;
        malformed += other.malformed > 0;
        recording_close(&other);
    }
    /* The wounds are of all sorts. */
    CU_ASSERT(refused > 0 && refused < rounds / 2);
    CU_ASSERT(fewer > rounds / 10 && malformed > rounds / 20);
}

int main(void)
{
    CU_TestInfo tests[] = {{"the sample itself", test_the_sample_itself},
                           {"wounded runs", test_wounded_runs},
                           CU_TEST_INFO_NULL};
    int code = suite_run("story/garbage", tests);
    recording_close(&whole);
    unlink(rich.path);
    return code;
}
