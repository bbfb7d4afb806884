/* SPDX-License-Identifier: Apache-2.0 */
#include "world/condition/condition.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <string.h>

static const char *const bodies[] = {"red", "blue", "r.2", "puck1"};
static struct condition_numbers numbers[] = {
    {.x_m = 1, .distance_m = 4, .stalls = 2},
    {.x_m = 1.3, .y_m = 0.4, .distance_m = 6},
    {.x_m = 9, .distance_m = 100, .stalled_s = 3.5},
    {.x_m = 1, .y_m = 1},
};

static int body_find(const void *self, const char *name)
{
    (void)self;
    for (int i = 0; i < 4; i++) {
        if (strcmp(bodies[i], name) == 0) {
            return i;
        }
    }
    return -1;
}

static void body_numbers(const void *self, int body, struct condition_numbers *out)
{
    (void)self;
    *out = numbers[body];
}

static bool is_blue(const void *self, int robot)
{
    (void)self;
    return robot == 1;
}

static bool is_not_last(const void *self, int robot)
{
    (void)self;
    return robot < 2;
}

static const struct condition_names names = {.find = body_find, .robots = 3};
static const struct condition_view view = {
    .time_s = 12, .numbers = body_numbers, .stalled = is_blue, .counts = is_not_last, .robots = 3};
static char why[CONDITION_WHY_MAX];

static void test_what_is_so(void)
{
    static const struct {
        const char *text;
        bool so;
    } rows[] = {
        {"time > 11.9", true},
        {"time > 12", false},
        {"time >= 12", true},
        {"time < 12", false},
        {"time <= 12", true},
        {"red.distance_m > 3", true},
        {"red.stalls >= 3", false},
        {"r.2.stalled_s > 3", true},
        {"robots.distance_m > 4.9", true}, /* the mean of red and blue */
        {"robots.distance_m > 5.1", false},
        {"red near blue 0.5", true},
        {"red near blue 0.49", false},
        {"red not near blue 0.49", true},
        {"red near puck1 1", true},
        {"puck1 at 1 1 0.1", true},
        {"red not at 0 0 1", false},
        {"red stalled", false},
        {"red not stalled", true},
        {"  blue   stalled ", true},
    };
    struct condition c;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        CU_ASSERT_EQUAL_FATAL(condition_read(&c, rows[i].text, &names, why), MU_OK);
        CU_ASSERT_EQUAL(condition_holds(&c, &view, false), rows[i].so);
    }
}

static void test_what_happens(void)
{
    struct condition c;
    CU_ASSERT_EQUAL(condition_read(&c, "red told near-wall", &names, why), MU_OK);
    CU_ASSERT(condition_holds(&c, &view, true) && !condition_holds(&c, &view, false));
    CU_ASSERT(condition_told(&c, "near-wall 1 2", "blue"));
    CU_ASSERT(condition_told(&c, "near-wall", "all"));
    CU_ASSERT(!condition_told(&c, "near-walls", "all"));
    CU_ASSERT(!condition_told(&c, "is near-wall", "all"));
    CU_ASSERT(!condition_told(&c, "", "all"));
    CU_ASSERT_EQUAL(condition_read(&c, "red told x to blue", &names, why), MU_OK);
    CU_ASSERT(condition_told(&c, "x", "blue") && condition_told(&c, "x", "green,blue"));
    CU_ASSERT(!condition_told(&c, "x", "bluer,green") && !condition_told(&c, "x", "role:blue"));
    CU_ASSERT_EQUAL(condition_read(&c, "red not told x to group:g", &names, why), MU_OK);
    CU_ASSERT(condition_told(&c, "x", "group:g") && !condition_told(&c, "x", "blue"));
    CU_ASSERT(!condition_holds(&c, &view, true) && condition_holds(&c, &view, false));
    CU_ASSERT_EQUAL(condition_read(&c, "r.2 fired turn", &names, why), MU_OK);
    CU_ASSERT_EQUAL(c.body, 2);
    CU_ASSERT(condition_fired(&c, "go turn stop") && condition_fired(&c, "turn"));
    CU_ASSERT(!condition_fired(&c, "turned return") && !condition_fired(&c, ""));
    CU_ASSERT(!condition_told(&c, "turn", "blue"));
}

static void test_what_is_none(void)
{
    static const struct {
        const char *text, *expected;
    } rows[] = {
        {"", "expected near, at, stalled, told or fired behind a name, or NAME.NUMBER > VALUE, or "
             "time > S"},
        {"red", "expected near, at, stalled, told or fired behind a name, or NAME.NUMBER > VALUE, "
                "or time > S"},
        {"red likes blue", "expected near, at, stalled, told or fired behind a name, or "
                           "NAME.NUMBER > VALUE, or time > S"},
        {"red not", "expected near, at, stalled, told or fired behind a name, or NAME.NUMBER > "
                    "VALUE, or time > S"},
        {"pink stalled", "no robot 'pink' in this experiment"},
        {"puck1 stalled", "no robot 'puck1' in this experiment"},
        {"red near pink 1", "no robot or thing 'pink' in this experiment"},
        {"red near blue", "expected NAME near NAME METRES"},
        {"red near blue 0", "expected a distance of more than 0 m"},
        {"red near blue x", "expected a number, not x"},
        {"red near blue inf", "expected a number, not inf"},
        {"red at 1 2", "expected NAME at X Y METRES"},
        {"red stalled twice", "expected nothing behind stalled"},
        {"red told", "expected NAME told WORD, or NAME told WORD to RECEIVER"},
        {"red told a for b", "expected NAME told WORD, or NAME told WORD to RECEIVER"},
        {"red fired a b", "expected NAME fired RULE"},
        {"time > soon", "expected a number, not soon"},
        {"time >", "expected > >= < or <= and a number, each between blanks"},
        {"red.speed > 1",
         "expected one of x_m y_m heading_rad distance_m stalls stalled_s mail_sent "
         "mail_received rule_firings, not 'speed'"},
        {"red.stalls => 1", "expected near, at, stalled, told or fired behind a name, or "
                            "NAME.NUMBER > VALUE, or time > S"},
        {"red.stalls >> 1", "expected > >= < or <= and a number, each between blanks"},
        {"puck1.x_m > 1", "no robot 'puck1' in this experiment"},
        {"a b c d e f g h", "expected a shorter condition"},
        {"0123456789012345678901234567890123456789012345678901234567890123 stalled",
         "expected a shorter condition"},
    };
    struct condition c;
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        CU_ASSERT_EQUAL(condition_read(&c, rows[i].text, &names, why), MU_MALFORMED);
        READS(why, rows[i].expected);
    }
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"what is so", test_what_is_so},
        {"what happens", test_what_happens},
        {"what is none", test_what_is_none},
        CU_TEST_INFO_NULL,
    };
    return suite_run("world/condition", tests);
}
