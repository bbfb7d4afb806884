/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/session/script.h"
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

static void look(struct script *s, unsigned step)
{
    const struct condition_view view = {.time_s = step * 0.1,
                                        .numbers = body_numbers,
                                        .stalled = is_stalled,
                                        .counts = counts,
                                        .robots = 2};
    script_look(s, step * 100000000ull, &view);
}

static mu_result put(struct script *s, uint64_t seq, unsigned due_step, const char *condition)
{
    char source[] = "chaos", name[] = "red", none[] = "", when[64];
    snprintf(when, sizeof when, "%s", condition);
    muster_RunCommand c = {.source = source,
                           .seq = seq,
                           .name = name,
                           .file = none,
                           .when = when,
                           .due_ns = due_step * 100000000ull};
    mu_result result = script_put(s, &c, why);
    memset(when, '?', sizeof when - 1); /* what was given is not kept */
    return result;
}

/* @return the number of the next order, or 0 */
static uint64_t next(struct script *s)
{
    const muster_RunCommand *c = script_next(s);
    return c ? c->seq : 0;
}

static void mail(struct script *s, int robot, const char *content, const char *rules)
{
    char text[64], dst[] = "all", fired[64];
    snprintf(text, sizeof text, "%s", content);
    snprintf(fired, sizeof fired, "%s", rules);
    muster_Mail m = {.dst = dst, .content = text};
    muster_Act act = {.rules = fired, .mails = {._length = 1, ._buffer = &m}};
    script_act(s, robot, &act);
}

static void test_times(void)
{
    struct script *s = script_open(&names);
    CU_ASSERT_EQUAL(put(s, 1, 3, ""), MU_OK);
    CU_ASSERT_EQUAL(put(s, 2, 1, ""), MU_OK);
    look(s, 0);
    CU_ASSERT_EQUAL(next(s), 0);
    look(s, 1);
    CU_ASSERT_EQUAL(next(s), 2);
    CU_ASSERT_EQUAL(next(s), 0);
    look(s, 2);
    CU_ASSERT_EQUAL(next(s), 0);
    look(s, 3);
    CU_ASSERT_EQUAL(next(s), 1);
    look(s, 4);
    CU_ASSERT_EQUAL(next(s), 0);
}

static void test_conditions(void)
{
    struct script *s = script_open(&names);
    CU_ASSERT_EQUAL(put(s, 1, 0, "red stalled"), MU_OK);
    CU_ASSERT_EQUAL(put(s, 2, 5, "red stalled"), MU_OK); /* and not before that time */
    CU_ASSERT_EQUAL(put(s, 3, 0, "blue told help"), MU_OK);
    CU_ASSERT_EQUAL(put(s, 4, 0, "red fired flee"), MU_OK);
    CU_ASSERT_EQUAL(put(s, 5, 0, "red likes blue"), MU_MALFORMED);
    CU_ASSERT(why[0] != '\0');
    look(s, 0);
    CU_ASSERT_EQUAL(next(s), 0);
    stalled[0] = true;
    look(s, 1);
    CU_ASSERT_EQUAL(next(s), 1);
    CU_ASSERT_EQUAL(next(s), 0);
    mail(s, 0, "help", ""); /* of another robot */
    mail(s, 1, "helps", "flee");
    look(s, 2);
    CU_ASSERT_EQUAL(next(s), 0);
    mail(s, 1, "help me", "");
    mail(s, 0, "x", "go flee");
    look(s, 3);
    CU_ASSERT_EQUAL(next(s), 3);
    CU_ASSERT_EQUAL(next(s), 4);
    look(s, 5);
    CU_ASSERT_EQUAL(next(s), 2);
    stalled[0] = false;
}

static void test_limit_later(void)
{
    struct script *s = script_open(&names);
    for (uint64_t i = 1; i <= MU_ORDERS_LATER_MAX; i++) {
        CU_ASSERT_EQUAL(put(s, i, 1, ""), MU_OK);
    }
    CU_ASSERT_EQUAL(put(s, 999, 1, ""), MU_FULL);
    look(s, 1);
    CU_ASSERT_EQUAL(next(s), 1);
    CU_ASSERT_EQUAL(put(s, 999, 2, ""), MU_OK); /* there is room again */
    for (uint64_t i = 2; i <= MU_ORDERS_LATER_MAX; i++) {
        CU_ASSERT_EQUAL(next(s), i);
    }
    CU_ASSERT_EQUAL(next(s), 0);
}

static void test_events(void)
{
    static const char *const events[] = {"red stalled", "red not stalled", "blue told help",
                                         "red near blue 1"};
    char path[] = "/tmp/muster-events-XXXXXX", text[1024];
    int fd = mkstemp(path);
    CU_ASSERT_FATAL(fd >= 0);
    struct script *s = script_open(&names);
    CU_ASSERT_EQUAL_FATAL(script_record(s, path, events, 4), MU_OK);
    numbers[1].x_m = 5;
    look(s, 0);
    stalled[0] = true;
    mail(s, 1, "help", "");
    look(s, 1);
    mail(s, 1, "help", ""); /* a mail is an event each time, a state when it begins */
    numbers[1].x_m = 1;
    look(s, 2);
    stalled[0] = false;
    look(s, 3);
    CU_ASSERT_EQUAL(script_close(s), MU_OK);
    ssize_t len = read(fd, text, sizeof text - 1);
    text[len > 0 ? len : 0] = '\0';
    READS(text, "time_s,event\n0.000,red not stalled\n0.100,red stalled\n0.100,blue told help\n"
                "0.200,blue told help\n0.200,red near blue 1\n0.300,red not stalled\n");
    close(fd);
    unlink(path);
}

static void test_a_full_disk(void)
{
    static const char *const events[] = {"time >= 0", "red told a"};
    struct script *s = script_open(&names);
    CU_ASSERT_EQUAL_FATAL(script_record(s, "/dev/full", events, 2), MU_OK);
    look(s, 0);
    CU_ASSERT_EQUAL(script_close(s), MU_FAULT_OS);
    s = script_open(&names);
    CU_ASSERT_EQUAL(script_record(s, "/nowhere/events.csv", events, 2), MU_FAULT_OS);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"times", test_times},
        {"conditions", test_conditions},
        {"limit: later", test_limit_later},
        {"events", test_events},
        {"a full disk", test_a_full_disk},
        CU_TEST_INFO_NULL,
    };
    return suite_run("sim/script", tests);
}
