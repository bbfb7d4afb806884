/* SPDX-License-Identifier: Apache-2.0 */
/* Changes from outside wait in one order, whatever the one of their arrival, and only so many;
 * those of later wait for their time or condition.  Events are written down when they come true. */
#include "capture.h"
#include "physics.h"
#include "sim/record/record.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static struct condition_numbers numbers[2];
static bool stalled[2];

static int body_find(const void *self, const char *name)
{
    (void)self;
    return strcmp(name, "red") == 0 ? 0 : strcmp(name, "blue") == 0 ? 1 : -1;
}

static void body_numbers(const void *self, int body, struct condition_numbers *out)
{
    (void)self;
    *out = numbers[body];
}

static bool is_stalled(const void *self, int robot)
{
    (void)self;
    return stalled[robot];
}

static bool counts(const void *self, int robot)
{
    (void)self;
    (void)robot;
    return true;
}

static const struct condition_names names = {.find = body_find, .robots = 2};
static char why[CONDITION_WHY_MAX];

static struct condition_view view_at(unsigned step)
{
    return (struct condition_view){.time_s = step * 0.1,
                                   .numbers = body_numbers,
                                   .stalled = is_stalled,
                                   .counts = counts,
                                   .robots = 2};
}

static void look(struct order_queue *q, unsigned step)
{
    const struct condition_view view = view_at(step);
    order_queue_look(q, step * 100000000ull, &view);
}

static mu_result put_from(struct order_queue *q, const char *from, uint64_t seq, unsigned due_step,
                          const char *condition)
{
    char source[16], name[16], file[] = "here", when[64];
    snprintf(source, sizeof source, "%s", from);
    snprintf(name, sizeof name, "n%llu", (unsigned long long)seq);
    snprintf(when, sizeof when, "%s", condition);
    muster_RunCommand c = {.source = source,
                           .seq = seq,
                           .name = name,
                           .file = file,
                           .when = when,
                           .x_m = 0.5,
                           .due_ns = due_step * 100000000ull};
    mu_result result = order_queue_put(q, &c, why);
    memset(source, '?', sizeof source - 1); /* what was given is not kept */
    memset(name, '?', sizeof name - 1);
    memset(when, '?', sizeof when - 1);
    return result;
}

static mu_result put(struct order_queue *q, uint64_t seq, unsigned due_step, const char *condition)
{
    return put_from(q, "chaos", seq, due_step, condition);
}

static void expect(struct order_queue *q, const char *source, uint64_t seq)
{
    const muster_RunCommand *c = order_queue_take(q);
    CU_ASSERT_PTR_NOT_NULL_FATAL(c);
    char name[16];
    snprintf(name, sizeof name, "n%llu", (unsigned long long)seq);
    READS(c->source, source);
    CU_ASSERT_EQUAL(c->seq, seq);
    READS(c->name, name);
    READS(c->file, "here");
    CU_ASSERT_DOUBLE_EQUAL(c->x_m, 0.5, 0);
}

/* @return the number of the next order, or 0 */
static uint64_t next(struct order_queue *q)
{
    const muster_RunCommand *c = order_queue_take(q);
    return c ? c->seq : 0;
}

static struct {
    muster_Mail mail;
    muster_Act act;
    char text[64], dst[4], fired[64];
} spoken;

static const muster_Act *act_of(const char *content, const char *rules)
{
    snprintf(spoken.text, sizeof spoken.text, "%s", content);
    snprintf(spoken.dst, sizeof spoken.dst, "all");
    snprintf(spoken.fired, sizeof spoken.fired, "%s", rules);
    spoken.mail = (muster_Mail){.dst = spoken.dst, .content = spoken.text};
    spoken.act =
        (muster_Act){.rules = spoken.fired, .mails = {._length = 1, ._buffer = &spoken.mail}};
    return &spoken.act;
}

static void mail(struct order_queue *q, int robot, const char *content, const char *rules)
{
    order_queue_note_act(q, robot, act_of(content, rules));
}

static void test_in_order_of_source_and_number(void)
{
    struct order_queue *q = order_queue_open(&names);
    CU_ASSERT_EQUAL(put_from(q, "operator", 9, 0, ""), MU_OK);
    CU_ASSERT_EQUAL(put_from(q, "red", 1, 0, ""), MU_OK);
    CU_ASSERT_EQUAL(put_from(q, "observer", 70, 0, ""), MU_OK);
    CU_ASSERT_EQUAL(put_from(q, "operator", 8, 0, ""), MU_OK);
    expect(q, "observer", 70);
    expect(q, "operator", 8);
    expect(q, "operator", 9);
    expect(q, "red", 1);
    CU_ASSERT_PTR_NULL(order_queue_take(q));
}

/* Also when places of the queue are used again. */
static void test_equal_ones_as_they_came(void)
{
    struct order_queue *q = order_queue_open(&names);
    CU_ASSERT_EQUAL(put(q, 1, 1, ""), MU_OK);
    CU_ASSERT_EQUAL(put_from(q, "a", 3, 0, ""), MU_OK);
    CU_ASSERT_EQUAL(put(q, 1, 0, "red stalled"), MU_OK);
    expect(q, "a", 3);
    CU_ASSERT_PTR_NULL(order_queue_take(q));
    CU_ASSERT_EQUAL(put(q, 1, 0, ""), MU_OK);
    stalled[0] = true;
    look(q, 1);
    stalled[0] = false;
    CU_ASSERT_EQUAL(order_queue_take(q)->due_ns, 100000000);
    CU_ASSERT_EQUAL(order_queue_take(q)->when[0], 'r');
    CU_ASSERT_EQUAL(order_queue_take(q)->when[0], '\0');
    CU_ASSERT_PTR_NULL(order_queue_take(q));
}

/* An order that is being carried out may bring about another one. */
static void test_an_order_is_good_until_the_next(void)
{
    struct order_queue *q = order_queue_open(&names);
    CU_ASSERT_EQUAL(put(q, 1, 0, ""), MU_OK);
    const muster_RunCommand *c = order_queue_take(q);
    CU_ASSERT_EQUAL(put(q, 2, 1, ""), MU_OK);
    READS(c->name, "n1");
    CU_ASSERT_PTR_NULL(order_queue_take(q));
}

static void test_limit_orders_of_a_step(void)
{
    struct order_queue *q = order_queue_open(&names);
    for (uint64_t i = 0; i < MU_ORDERS_MAX; i++) {
        CU_ASSERT_EQUAL(put_from(q, "a", i, 0, ""), MU_OK);
    }
    CU_ASSERT_EQUAL(put_from(q, "a", MU_ORDERS_MAX, 0, ""), MU_FULL);
    READS(why, "too many orders in one step");
    CU_ASSERT_EQUAL(put(q, 1, 1, ""), MU_OK); /* those of later have places of their own */
    for (uint64_t i = 0; i < MU_ORDERS_MAX; i++) {
        expect(q, "a", i);
    }
    CU_ASSERT_PTR_NULL(order_queue_take(q));
    CU_ASSERT_EQUAL(put_from(q, "a", 1, 0, ""), MU_OK);
    expect(q, "a", 1);
}

static void test_times(void)
{
    struct order_queue *q = order_queue_open(&names);
    CU_ASSERT_EQUAL(put(q, 1, 3, ""), MU_OK);
    CU_ASSERT_EQUAL(put(q, 2, 1, ""), MU_OK);
    look(q, 0);
    CU_ASSERT_EQUAL(next(q), 0);
    look(q, 1);
    CU_ASSERT_EQUAL(next(q), 2);
    CU_ASSERT_EQUAL(next(q), 0);
    look(q, 2);
    CU_ASSERT_EQUAL(next(q), 0);
    look(q, 3);
    CU_ASSERT_EQUAL(next(q), 1);
    look(q, 4);
    CU_ASSERT_EQUAL(next(q), 0);
}

static void test_conditions(void)
{
    struct order_queue *q = order_queue_open(&names);
    CU_ASSERT_EQUAL(put(q, 1, 0, "red stalled"), MU_OK);
    CU_ASSERT_EQUAL(put(q, 2, 5, "red stalled"), MU_OK); /* and not before that time */
    CU_ASSERT_EQUAL(put(q, 3, 0, "blue told help"), MU_OK);
    CU_ASSERT_EQUAL(put(q, 4, 0, "red fired flee"), MU_OK);
    CU_ASSERT_EQUAL(put(q, 5, 0, "red likes blue"), MU_MALFORMED);
    CU_ASSERT(why[0] != '\0');
    look(q, 0);
    CU_ASSERT_EQUAL(next(q), 0);
    stalled[0] = true;
    look(q, 1);
    CU_ASSERT_EQUAL(next(q), 1);
    CU_ASSERT_EQUAL(next(q), 0);
    mail(q, 0, "help", ""); /* of another robot */
    mail(q, 1, "helps", "flee");
    look(q, 2);
    CU_ASSERT_EQUAL(next(q), 0);
    mail(q, 1, "help me", "");
    mail(q, 0, "x", "go flee");
    look(q, 3);
    CU_ASSERT_EQUAL(next(q), 3);
    CU_ASSERT_EQUAL(next(q), 4);
    look(q, 5);
    CU_ASSERT_EQUAL(next(q), 2);
    stalled[0] = false;
}

static void test_limit_later(void)
{
    struct order_queue *q = order_queue_open(&names);
    for (uint64_t i = 1; i <= MU_ORDERS_LATER_MAX; i++) {
        CU_ASSERT_EQUAL(put(q, i, 1, ""), MU_OK);
    }
    CU_ASSERT_EQUAL(put(q, 999, 1, ""), MU_FULL);
    READS(why, "too many orders wait");
    look(q, 1);
    CU_ASSERT_EQUAL(next(q), 1);
    CU_ASSERT_EQUAL(next(q), 2);
    CU_ASSERT_EQUAL(put(q, 999, 2, ""), MU_OK); /* there is room again */
    for (uint64_t i = 3; i <= MU_ORDERS_LATER_MAX; i++) {
        CU_ASSERT_EQUAL(next(q), i);
    }
    CU_ASSERT_EQUAL(next(q), 0);
}

/* --- events ----------------------------------------------------------------------------------- */

static void step(struct events *e, unsigned step)
{
    const struct condition_view view = view_at(step);
    events_look(e, step * 100000000ull, &view);
}

static void tell(struct events *e, int robot, const char *content)
{
    events_note_act(e, robot, act_of(content, ""));
}

static void test_events(void)
{
    static const struct mu_option_list texts = {
        {"red stalled", "red not stalled", "blue told help", "red near blue 1"}, 4};
    char path[] = "/tmp/muster-events-XXXXXX", text[1024];
    int fd = mkstemp(path);
    CU_ASSERT_FATAL(fd >= 0);
    struct events *e;
    CU_ASSERT_EQUAL_FATAL(events_open(&e, path, &texts, &names), MU_OK);
    numbers[1].x_m = 5;
    step(e, 0);
    stalled[0] = true;
    tell(e, 1, "help");
    step(e, 1);
    tell(e, 1, "help"); /* a mail is an event each time, a state when it begins */
    numbers[1].x_m = 1;
    step(e, 2);
    stalled[0] = false;
    step(e, 3);
    CU_ASSERT_EQUAL(events_close(e), MU_OK);
    ssize_t len = read(fd, text, sizeof text - 1);
    text[len > 0 ? len : 0] = '\0';
    READS(text, "time_s,event\n0.000,red not stalled\n0.100,red stalled\n0.100,blue told help\n"
                "0.200,blue told help\n0.200,red near blue 1\n0.300,red not stalled\n");
    close(fd);
    unlink(path);
}

static void test_a_full_disk(void)
{
    static const struct mu_option_list texts = {{"time >= 0", "red told a"}, 2};
    struct events *e;
    capture_begin();
    CU_ASSERT_EQUAL_FATAL(events_open(&e, "/dev/full", &texts, &names), MU_OK);
    step(e, 0);
    CU_ASSERT_EQUAL(events_close(e), MU_FAULT_OS);
    CU_ASSERT_EQUAL(events_open(&e, "/nowhere/events.csv", &texts, &names), MU_FAULT_OS);
    capture_end();
    CU_ASSERT(said("cannot write /dev/full") && said("cannot create /nowhere/events.csv"));
}

static void test_what_is_no_event(void)
{
    static const struct mu_option_list texts = {{"red likes blue"}, 1};
    static struct mu_option_list many = {.count = 65};
    struct events *e;
    for (size_t i = 0; i < many.count; i++) {
        many.items[i] = "time >= 0";
    }
    capture_begin();
    CU_ASSERT_EQUAL(events_open(&e, "/nowhere/events.csv", &texts, &names), MU_FAULT_USAGE);
    CU_ASSERT_EQUAL(events_open(&e, "/nowhere/events.csv", &many, &names), MU_FAULT_USAGE);
    capture_end();
    CU_ASSERT(said("event 'red likes blue'") && said("at most 64 events"));
}

/* A world names its robots, then its objects. */
static void test_names_of_a_world(void)
{
    physics_clear();
    physics_robot(0, 0, 0);
    physics_robot(1, 0, 0);
    struct world_object *box = physics_object(2, 0, 0.1);
    const struct condition_names found =
        record_names(&physics_world, &(struct mu_option_list){.count = 0});
    CU_ASSERT_EQUAL(found.robots, 2);
    CU_ASSERT_EQUAL(found.find(found.self, "robot1"), 1);
    CU_ASSERT_EQUAL(record_find_body(&physics_world, box->name), 2);
    CU_ASSERT_EQUAL(record_find_body(&physics_world, "nobody"), -1);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"in order of source and number", test_in_order_of_source_and_number},
        {"equal ones as they came", test_equal_ones_as_they_came},
        {"an order is good until the next", test_an_order_is_good_until_the_next},
        {"limit: orders of a step", test_limit_orders_of_a_step},
        {"times", test_times},
        {"conditions", test_conditions},
        {"limit: later", test_limit_later},
        {"events", test_events},
        {"a full disk", test_a_full_disk},
        {"what is no event", test_what_is_no_event},
        {"names of a world", test_names_of_a_world},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/order_queue", tests);
}
