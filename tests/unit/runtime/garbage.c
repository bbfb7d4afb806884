/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Damaged samples, for who watches: of each topic they are refused at the border or are read, and
 * what is read of Scene and Frame goes through a watch and the statistics.  Then the same over DDS,
 * to a watch of a program.  From another seed where MUSTER_SEED names one, and so many times as
 * MUSTER_ROUNDS says: make soak-strangers.
 */
#include "bus/raw/raw.h"
#include "muster/monitor.h"
#include "muster/stats.h"
#include "rich.h"
#include "runtime/process.h"
#include "runtime/watch.h"
#include "suite.h"
#include "wound.h"

#include <stdlib.h>
#include <unistd.h>

enum { ROUNDS = 6000, WIRE_SHARE = 10, SAMPLE_MAX = 8192 };

static uint64_t seed, rounds;
static struct mu_random random_source;
static struct watch_room *room;
static mu_stats *stats;
static uint8_t sample[SAMPLE_MAX], wounded[SAMPLE_MAX + WOUND_ROOM];

/* --- samples ---------------------------------------------------------------------------------- */

/* Of what observers see there is something in each field; of the other topics, little. */
static const void *sample_of(enum bus_topic topic)
{
    static muster_Scene scene;
    static muster_Frame frame;
    static muster_RunStatus status;
    static struct one_up up;
    static muster_Mail mail;
    static union {
        char bytes[4096];
        long double aligned;
    } empty;
    switch ((int)topic) {
    case BUS_SCENE: scene = rich_scene(); return &scene;
    case BUS_FRAME: frame = rich_frame(mu_random_between(&random_source, 0, 99)); return &frame;
    case BUS_RUN_STATUS: status = rich_status(); return &status;
    case BUS_UP:
        mail = letter("red", 7, "blue", "hello");
        one_up(&up, "red", "p1", &mail, 1, 3);
        return &up.up;
    default: return &empty;
    }
}

static size_t sample_make(enum bus_topic topic)
{
    static struct bus_bytes bytes;
    CU_ASSERT_EQUAL_FATAL(bus_encode(topic, sample_of(topic), &bytes), MU_OK);
    CU_ASSERT_FATAL(bytes.size <= sizeof sample);
    memcpy(sample, bytes.data, bytes.size);
    return bytes.size;
}

/* Copies a sample with wounds, most of them behind its head. */
static size_t sample_wound(enum bus_topic topic)
{
    size_t len = sample_make(topic);
    memcpy(wounded, sample, len);
    return 4 + wound_bytes(&random_source, wounded + 4, len - 4);
}

/* --- reading all that a handler is given -------------------------------------------------------
 */

static uint64_t sum; /* so that everything is looked at */

static void text_read(const char *text)
{
    sum += strlen(text);
}

static void outline_read(const struct mu_outline *o)
{
    for (size_t i = 0; i < 2 * o->corner_count; i++) {
        sum += o->corners_m[i] > 0;
    }
}

static void figures_read(const struct mu_figure *figures, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        text_read(figures[i].name);
        text_read(figures[i].color);
        outline_read(&figures[i].shape);
    }
}

static void on_scene(void *self, const struct mu_scene *s)
{
    (void)self;
    text_read(s->simulator);
    text_read(s->world);
    for (size_t i = 0; i < s->wall_count; i++) {
        outline_read(&s->walls[i]);
    }
    figures_read(s->robots, s->robot_count);
    figures_read(s->objects, s->object_count);
    mu_stats_begin(stats, s);
}

static void mails_read(const struct mu_mail *mails, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct mu_mail *m = &mails[i];
        const char *const texts[] = {m->performative, m->language, m->ontology,  m->content,
                                     m->src,          m->dst,      m->reply_with};
        for (size_t t = 0; t < sizeof texts / sizeof texts[0]; t++) {
            text_read(texts[t]);
        }
    }
}

static void stats_read(void)
{
    struct mu_stats_pair pair;
    uint64_t count;
    struct mu_stats_team team = mu_stats_team(stats);
    sum += team.stalls;
    for (size_t i = 0; i < mu_stats_count(stats); i++) {
        text_read(mu_stats_robot(stats, i)->name);
    }
    for (size_t i = 0; mu_stats_performative(stats, i, &count); i++) {
        text_read(mu_stats_performative(stats, i, &count));
    }
    for (size_t i = 0; mu_stats_pair(stats, i, &pair); i++) {
        sum += pair.one;
    }
}

static uint64_t last_missed;

static void on_step(void *self, const struct mu_frame *f)
{
    (void)self;
    last_missed = f->missed;
    for (size_t i = 0; i < f->robot_count; i++) {
        text_read(f->robots[i].name);
        CU_ASSERT((unsigned)f->robots[i].state <= MU_GONE);
    }
    for (size_t i = 0; i < f->object_count; i++) {
        text_read(f->objects[i].name);
    }
    for (size_t i = 0; i < f->act_count; i++) {
        text_read(f->acts[i].agent);
        text_read(f->acts[i].rules);
        text_read(f->acts[i].diary);
        mails_read(f->acts[i].mails, f->acts[i].mail_count);
    }
    mails_read(f->outside, f->outside_count);
    mu_stats_take(stats, f);
    stats_read();
}

static void on_end(void *self, const struct mu_run_result *r)
{
    (void)self;
    text_read(r->hash);
    text_read(r->reason);
}

/* --- at the border ---------------------------------------------------------------------------- */

static uint64_t decoded[BUS_TOPICS];

static void one_decode(enum bus_topic topic)
{
    void *got = NULL;
    size_t len = sample_wound(topic);
    if (bus_decode(topic, wounded, len, &got) != MU_OK) {
        CU_ASSERT_PTR_NULL(got);
        return;
    }
    decoded[topic]++;
    if (topic == BUS_SCENE) {
        on_scene(NULL, watch_scene(room, got));
    } else if (topic == BUS_FRAME) {
        on_step(NULL, watch_frame(room, got));
    }
    bus_decode_free(topic, got);
}

static void test_wounded_samples_of_each_topic(void)
{
    printf("seed %llu ", (unsigned long long)seed);
    for (uint64_t round = 0; round < rounds; round++) {
        one_decode((enum bus_topic)(round % BUS_TOPICS));
        one_decode(round % 2 ? BUS_FRAME : BUS_SCENE);
    }
    CU_ASSERT(decoded[BUS_FRAME] > rounds / 50);
    CU_ASSERT(decoded[BUS_SCENE] > rounds / 50);
    CU_ASSERT(decoded[BUS_RUN_STATUS] > 0);
}

/* --- over DDS --------------------------------------------------------------------------------- */

static struct feed scenes, frames, statuses;

static mu_result wire_write(enum bus_topic topic, const uint8_t *bytes, size_t size)
{
    struct feed *feed = topic == BUS_SCENE ? &scenes : topic == BUS_FRAME ? &frames : &statuses;
    return feed_write(feed, bytes, size);
}

/* Whole samples and wounded ones by turns; with the wounded ones a run may begin, go on or end. */
static void wire_round(mu_watch *w)
{
    static const enum bus_topic topics[] = {BUS_FRAME, BUS_SCENE, BUS_FRAME, BUS_RUN_STATUS,
                                            BUS_FRAME};
    enum bus_topic topic =
        topics[mu_random_between(&random_source, 0, sizeof topics / sizeof topics[0] - 1)];
    bool whole = mu_random_between(&random_source, 0, 4) == 0;
    size_t len = whole ? sample_make(topic) : sample_wound(topic);
    mu_result written = wire_write(topic, whole ? sample : wounded, len);
    CU_ASSERT(written == MU_OK || (!whole && written == MU_MALFORMED));
    mu_result spun = mu_watch_spin(w, 0);
    CU_ASSERT(spun == MU_OK || spun == MU_DONE);
}

/* A step far beyond all others: what was missed before it is counted, and nothing overflows. */
static void last_step_tell(mu_watch *w)
{
    static struct bus_bytes bytes;
    muster_Frame f = rich_frame(0);
    f.step = INT64_MAX;
    CU_ASSERT_EQUAL_FATAL(wire_write(BUS_SCENE, sample, sample_make(BUS_SCENE)), MU_OK);
    CU_ASSERT_EQUAL(mu_watch_spin(w, 0), MU_OK);
    CU_ASSERT_EQUAL_FATAL(bus_encode(BUS_FRAME, &f, &bytes), MU_OK);
    CU_ASSERT_EQUAL(wire_write(BUS_FRAME, bytes.data, bytes.size), MU_OK);
    for (int i = 0; i < 1000 && last_missed == 0; i++) {
        CU_ASSERT_EQUAL(mu_watch_spin(w, 1000000), MU_OK);
    }
    CU_ASSERT_EQUAL(last_missed, INT64_MAX);
    CU_ASSERT_EQUAL(mu_watch_missed(w), INT64_MAX);
    bus_bytes_free(&bytes);
}

static void test_a_watch_of_wounded_samples(void)
{
    struct mu_process_options process = {.domain = 100 + (int)(getpid() % 100), .name = "watcher"};
    struct mu_watch_options options = {
        .handlers = {.on_scene = on_scene, .on_step = on_step, .on_end = on_end}};
    mu_process *p;
    mu_watch *w;
    CU_ASSERT_EQUAL_FATAL(mu_process_open(&p, &process), MU_OK);
    CU_ASSERT_EQUAL_FATAL(mu_watch_open(&w, p, &options), MU_OK);
    CU_ASSERT_EQUAL_FATAL(feed_open(&scenes, &p->bus, BUS_SCENE, NULL, NULL), MU_OK);
    CU_ASSERT_EQUAL_FATAL(feed_open(&frames, &p->bus, BUS_FRAME, "every", NULL), MU_OK);
    CU_ASSERT_EQUAL_FATAL(feed_open(&statuses, &p->bus, BUS_RUN_STATUS, NULL, NULL), MU_OK);
    last_step_tell(w);
    uint64_t before = sum;
    for (uint64_t round = 0; round < rounds / WIRE_SHARE; round++) {
        wire_round(w);
    }
    CU_ASSERT(sum > before);            /* something was read, */
    CU_ASSERT(mu_watch_refused(w) > 0); /* and something refused */
    mu_watch_close(w);
    mu_process_close(p);
}

int main(void)
{
    unsetenv("CYCLONEDDS_URI");
    seed = suite_setting("MUSTER_SEED", 41);
    rounds = suite_setting("MUSTER_ROUNDS", ROUNDS);
    mu_random_seed(&random_source, seed, "wounded samples");
    room = watch_room_take();
    stats = mu_stats_open();
    CU_TestInfo tests[] = {
        {"wounded samples of each topic", test_wounded_samples_of_each_topic},
        {"a watch of wounded samples", test_a_watch_of_wounded_samples},
        CU_TEST_INFO_NULL,
    };
    return suite_run("runtime/garbage", tests);
}
