/* SPDX-License-Identifier: Apache-2.0 */
/* Orders to the world, in words. */
#include "core/sensors.h"
#include "muster/agent.h"
#include "operator/operator.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <string.h>

enum { WORDS_MAX = 8 };

static muster_RunCommand c;
static char wrong[WORLD_WORDS_WRONG];

/* Reads a line's words, with one blank between. */
static mu_result say(const char *line)
{
    static char bytes[256];
    const char *words[WORDS_MAX];
    size_t count = 0;
    wrong[0] = '\0';
    snprintf(bytes, sizeof bytes, "%s", line);
    for (char *at = bytes; at && *at && count < WORDS_MAX; count++) {
        words[count] = strsep(&at, " ");
    }
    return world_words_read(words, count, 0.1, &c, wrong);
}

static void good(const char *line, muster_RunOrder order, const char *name)
{
    CU_ASSERT_EQUAL(say(line), MU_OK);
    CU_ASSERT_EQUAL(c.order, order);
    READS(c.name, name);
}

static void test_orders(void)
{
    good("place red 1 -2.5", muster_RUN_PLACE, "red");
    CU_ASSERT(c.x_m == 1 && c.y_m == -2.5 && c.keeps_heading);
    good("place box1 1 2 450", muster_RUN_PLACE, "box1");
    CU_ASSERT(!c.keeps_heading && fabs(c.heading_rad - M_PI / 2) < 1e-12);
    good("push red 10 0 0.5", muster_RUN_PUSH, "red");
    CU_ASSERT(c.force_x_n == 10 && c.torque_nm == 0.5 && c.time_s == 0.1);
    good("reset", muster_RUN_RESET, "");
    good("reset red", muster_RUN_RESET, "red");
    good("sensor red laser off", muster_RUN_SENSOR, "red");
    CU_ASSERT(c.senses == MU_SENSE_LASER && !c.on);
    good("sensor red all on", muster_RUN_SENSOR, "red");
    CU_ASSERT(c.senses == MU_SENSES && c.on);
    good("pace 0", muster_RUN_PACE, "");
    good("save here.state", muster_RUN_SAVE, "");
    READS(c.file, "here.state");
}

static void bad(const char *line, const char *said)
{
    CU_ASSERT_EQUAL(say(line), MU_FAULT_USAGE);
    READS(wrong, said);
}

static void test_what_is_no_order(void)
{
    bad("", "expected place, push, reset, sensor, pace or save");
    bad("go red", "expected place, push, reset, sensor, pace or save");
    bad("place red 1", "expected place NAME X Y [DEG]");
    bad("place red 1 2 3 4", "expected place NAME X Y [DEG]");
    bad("place red 1 x", "'x': expected a number");
    bad("place red nan 1", "'nan': expected a number");
    bad("push red 1 1e999", "'1e999': expected a number");
    bad("pace -1", "'-1': expected times real time, or 0: as fast as it goes");
    char words[256];
    snprintf(words, sizeof words, "expected NAME, then %s or all, then on or off", MU_SENSOR_WORDS);
    bad("sensor red nose off", words);
    bad("reset a-name-of-32-characters-or-longer-",
        "'a-name-of-32-characters-...': no name is that long");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"orders", test_orders}, {"what is no order", test_what_is_no_order}, CU_TEST_INFO_NULL};
    return suite_run("operator/world", tests);
}
