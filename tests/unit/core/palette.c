/* SPDX-License-Identifier: Apache-2.0 */
#include "core/palette.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MANY = 1024, SOME = 200 };

static struct palette_color colors[MANY];

static double linear(double v)
{
    v /= 255;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

/* CIELAB of D65, CIE 15:2004. */
static void lab(const char *hex, double out[3])
{
    unsigned r, g, b;
    CU_ASSERT_EQUAL_FATAL(sscanf(hex, "#%2x%2x%2x", &r, &g, &b), 3);
    double c[3] = {linear(r), linear(g), linear(b)};
    double xyz[3] = {(0.4124 * c[0] + 0.3576 * c[1] + 0.1805 * c[2]) / 0.95047,
                     0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2],
                     (0.0193 * c[0] + 0.1192 * c[1] + 0.9505 * c[2]) / 1.08883};
    for (int i = 0; i < 3; i++) {
        xyz[i] = xyz[i] > 0.008856 ? cbrt(xyz[i]) : 7.787 * xyz[i] + 16.0 / 116;
    }
    out[0] = 116 * xyz[1] - 16;
    out[1] = 500 * (xyz[0] - xyz[1]);
    out[2] = 200 * (xyz[1] - xyz[2]);
}

static double distance(const char *one, const char *other)
{
    double a[3], b[3];
    lab(one, a);
    lab(other, b);
    return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

static void test_twenty_of_one_body_can_be_told_apart(void)
{
    static struct palette_robot robots[MANY];
    for (size_t i = 0; i < MANY; i++) {
        robots[i] = (struct palette_robot){"r", 0xff0000, false};
    }
    palette_choose(colors, robots, 20);
    for (size_t i = 0; i < 20; i++) {
        CU_ASSERT_EQUAL(colors[i].pattern, 0);
        for (size_t k = 0; k < i; k++) {
            CU_ASSERT(distance(colors[i].light, colors[k].light) > 40);
            CU_ASSERT(distance(colors[i].dark, colors[k].dark) > 33);
        }
    }
    palette_choose(colors, robots, MANY); /* as many as a run has */
    for (size_t i = 0; i < SOME; i++) {
        CU_ASSERT_EQUAL(colors[i].pattern > 0, i >= 20);
        for (size_t k = 0; k < i; k++) {
            CU_ASSERT_STRING_NOT_EQUAL(colors[i].light, colors[k].light);
        }
    }
}

static void test_own_colors_come_first_and_then_names(void)
{
    static const struct palette_robot robots[] = {
        {"green", 0xbebebe, false}, {"blue", 0x00ff00, false}, {"red", 0xbebebe, false},
        {"r", 0xbebebe, false},     {"s", 0x123456, false},    {"t", 0x0000fe, false},
        {"red", 0x00ff00, true}};
    palette_choose(colors, robots, 7);
    CU_ASSERT_STRING_EQUAL(colors[1].light, "#10bc4a"); /* its own: green */
    CU_ASSERT_STRING_EQUAL(colors[2].light, "#e70c44"); /* its name */
    CU_ASSERT_STRING_EQUAL(colors[5].light, "#0179d0"); /* near enough to blue */
    CU_ASSERT_STRING_EQUAL(colors[4].light, "#123456");
    CU_ASSERT_STRING_NOT_EQUAL(colors[4].dark, "#123456"); /* nobody would see it */
    CU_ASSERT_STRING_EQUAL(colors[0].light, "#d99600"); /* green is another's: the first free one */
    CU_ASSERT_STRING_EQUAL(colors[3].light, "#9e58c0");
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"twenty of one body can be told apart", test_twenty_of_one_body_can_be_told_apart},
        {"own colours come first, and then names", test_own_colors_come_first_and_then_names},
        CU_TEST_INFO_NULL,
    };
    return suite_run("core/palette", tests);
}
