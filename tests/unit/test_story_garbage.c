/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Damaged recordings of a run: whatever the wounds, what `muster verify`, `muster why` and the
 * page's slider ask of one is answered, and ends.  The wounds are in the file and, where its
 * checksums are mended, in the samples.  From another seed where MUSTER_SEED names one, and so many
 * times as MUSTER_ROUNDS says: make soak-strangers.
 */
#include "../support/rich.h"
#include "../support/suite.h"
#include "../support/wound.h"
#include "bus/bus.h"
#include "mcap/mcap_write.h"
#include "story/differ.h"
#include "story/stalls.h"
#include "story/why.h"

#include <stdlib.h>
#include <unistd.h>

enum { SAMPLE_MAX = 1 << 16, ROUNDS = 1500, STEPS = 12, STALLS_MAX = 4 };

static char path[] = "/tmp/muster-story-XXXXXX";
static uint8_t sample[SAMPLE_MAX], wounded[SAMPLE_MAX + WOUND_ROOM];
static size_t sample_len;
static struct recording whole, other;

/* --- a recording ------------------------------------------------------------------------------ */

static struct mcap_writer *writer;

static uint32_t channel_add(enum bus_topic topic)
{
    uint32_t index = MU_NONE;
    /* Without its definition the file is a third as long, and its wounds are in what is read. */
    struct mcap_channel c = {
        .topic = bus_topic_name(topic), .encoding = "cdr", .schema_name = "", .schema = ""};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_channel(writer, &c, &index), MU_OK);
    return index;
}

static void sample_add(uint32_t channel, enum bus_topic topic, const void *s, uint64_t log_ns)
{
    static struct bus_bytes bytes;
    CU_ASSERT_EQUAL_FATAL(bus_encode(topic, s, &bytes), MU_OK);
    struct mcap_message m = {
        .channel = channel, .log_ns = log_ns, .data = bytes.data, .size = bytes.size};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_message(writer, &m), MU_OK);
}

static void file_put(const uint8_t *bytes, size_t len)
{
    unlink(path); /* whoever has it open keeps what it was */
    FILE *file = fopen(path, "w");
    CU_ASSERT_PTR_NOT_NULL_FATAL(file);
    CU_ASSERT_EQUAL(fwrite(bytes, 1, len, file), len);
    fclose(file);
}

static void recording_write(void)
{
    static const struct mcap_pair about[] = {{"seed", "7"}, {"muster", MU_VERSION}};
    CU_ASSERT_EQUAL_FATAL(mcap_writer_open(writer, path, "test"), MU_OK);
    (void)mcap_writer_metadata(writer, "run", about, 2);
    muster_Scene scene = rich_scene();
    sample_add(channel_add(BUS_SCENE), BUS_SCENE, &scene, 0);
    uint32_t frames = channel_add(BUS_FRAME);
    for (int64_t step = 0; step < STEPS; step++) {
        muster_Frame f = rich_frame(step);
        sample_add(frames, BUS_FRAME, &f, f.time_ns);
        if (step == STEPS / 2) {
            mcap_writer_look(writer, UINT64_MAX / 2); /* another chunk */
        }
    }
    CU_ASSERT_EQUAL_FATAL(mcap_writer_close(writer), MU_OK);
    FILE *file = fopen(path, "r");
    sample_len = fread(sample, 1, sizeof sample, file);
    fclose(file);
    CU_ASSERT_FATAL(sample_len > 0 && sample_len < sizeof sample);
}

/* Memory for the longest file that a round may have. */
static void test_the_sample_itself(void)
{
    struct mu_fault fault;
    static uint8_t longest[SAMPLE_MAX + WOUND_ROOM];
    recording_write();
    file_put(longest, sizeof longest);
    CU_ASSERT_EQUAL_FATAL(recording_create(&whole, path, &fault), MU_OK);
    CU_ASSERT_EQUAL_FATAL(recording_create(&other, path, &fault), MU_OK);
    file_put(sample, sample_len);
    CU_ASSERT_EQUAL_FATAL(recording_open(&whole, path, &fault), MU_OK);
    CU_ASSERT_EQUAL(whole.steps_count, STEPS);
    CU_ASSERT_EQUAL(whole.malformed, 0);
}

/* --- questions -------------------------------------------------------------------------------- */

static uint32_t robot_ask(struct recording *r, const char *name, struct mu_text *out)
{
    struct stall stalls[STALLS_MAX];
    struct why why = {.minds = r->minds, .step_s = 0.1, .out = out};
    uint32_t ends = 0;
    uint32_t robot = stalls_robot(r, name);
    int32_t mind = minds_robot(r->minds, name);
    if (robot != MU_NONE) {
        size_t count = stalls_find(r, robot, stalls, STALLS_MAX);
        (void)stalls_at(stalls, count < STALLS_MAX ? count : STALLS_MAX, 5);
    }
    for (uint32_t step = 0; mind != MINDS_NONE && step <= STEPS; step += 3) {
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
    CU_ASSERT(differs || r->steps_count == STEPS || !mcap_reader_whole(r->reader));
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
        file_put(wounded, wound_file(&random, wounded, sample, sample_len));
        if (recording_open(&other, path, &fault) != MU_OK) {
            CU_ASSERT_NOT_EQUAL(fault.text[0], '\0');
            refused++;
            continue;
        }
        fewer += all_ask(&other) < STEPS;
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
    int fd = mkstemp(path);
    if (fd < 0 || close(fd) != 0) {
        return 1;
    }
    writer = mcap_writer_create();
    int code = suite_run("story/garbage", tests);
    recording_close(&whole);
    unlink(path);
    return code;
}
