/* SPDX-License-Identifier: Apache-2.0 */
#include "runtime/members.h"
#include "core/random.h"
#include "samples.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

static struct members members; /* static: leak checkers see its memory */

static void set_up(void)
{
    members_init(&members);
}

static void set(const char *name, muster_State state, uint32_t pid)
{
    muster_Member line = {.name = words(name),
                          .kind = muster_KIND_ROBOT,
                          .state = state,
                          .process = words("p1"),
                          .broker = words("b1"),
                          .host = words("here"),
                          .pid = pid,
                          .since_wall_ns = 7000000000u + pid};
    members_set(&members, &line);
}

static void test_a_line_is_copied_whole(void)
{
    char name[] = "red";
    set(name, muster_STATE_SUSPENDED, 42);
    name[0] = 'b';
    const struct mu_member *red = members_find(&members, "red");
    CU_ASSERT_PTR_NOT_NULL_FATAL(red);
    CU_ASSERT_STRING_EQUAL(red->name, "red");
    CU_ASSERT_EQUAL(red->kind, MU_KIND_ROBOT);
    CU_ASSERT_EQUAL(red->state, MU_SUSPENDED);
    CU_ASSERT_STRING_EQUAL(red->broker, "b1");
    CU_ASSERT_STRING_EQUAL(red->host, "here");
    CU_ASSERT_EQUAL(red->pid, 42);
    CU_ASSERT_EQUAL(red->since_wall_ns, 7000000042u);
}

static void test_order_and_update(void)
{
    static const char *const names[] = {"m", "a", "z", "b", "mm", "M", "_", "l"};
    static const char *const order[] = {"M", "_", "a", "b", "l", "m", "mm", "z"};
    enum { COUNT = sizeof names / sizeof names[0] };
    for (uint32_t i = 0; i < COUNT; i++) {
        set(names[i], muster_STATE_RUNNING, i);
        set(names[i], muster_STATE_RUNNING, i);
    }
    set("b", muster_STATE_ABSENT, 99);
    CU_ASSERT_EQUAL_FATAL(members.count, COUNT);
    for (size_t i = 0; i < COUNT; i++) {
        CU_ASSERT_STRING_EQUAL(members_at(&members, i)->name, order[i]);
        CU_ASSERT_PTR_EQUAL(members_find(&members, order[i]), members_at(&members, i));
    }
    CU_ASSERT_EQUAL(members_at(&members, 3)->state, MU_GONE);
    CU_ASSERT_EQUAL(members_at(&members, 3)->pid, 99);
    CU_ASSERT_EQUAL(members_at(&members, 2)->state, MU_RUNNING);
    static const char *const absent[] = {"", "A", "aa", "ll", "zz", "mmm"};
    for (size_t i = 0; i < sizeof absent / sizeof absent[0]; i++) {
        CU_ASSERT_PTR_NULL(members_find(&members, absent[i]));
    }
}

static void test_clear(void)
{
    CU_ASSERT_PTR_NULL(members_find(&members, "red"));
    set("red", muster_STATE_RUNNING, 1);
    members_clear(&members);
    CU_ASSERT_EQUAL(members.count, 0);
    CU_ASSERT_PTR_NULL(members_find(&members, "red"));
    set("blue", muster_STATE_RUNNING, 1);
    CU_ASSERT_EQUAL(members.count, 1);
}

static void test_limit_lines(void)
{
    struct mu_random r;
    char name[16];
    mu_random_seed(&r, 6, "members");
    while (members.count < MEMBERS_MAX) { /* in no order */
        snprintf(name, sizeof name, "n%llu", (unsigned long long)(mu_random_next(&r) % 100000));
        set(name, muster_STATE_RUNNING, 1);
    }
    bool in_order = true;
    for (size_t i = 1; i < members.count; i++) {
        in_order = in_order &&
                   strcmp(members_at(&members, i - 1)->name, members_at(&members, i)->name) < 0;
    }
    CU_ASSERT_TRUE(in_order);
    set("a", muster_STATE_RUNNING, 1);
    set("z", muster_STATE_RUNNING, 1);
    CU_ASSERT_EQUAL(members.count, MEMBERS_MAX);
    CU_ASSERT_PTR_NULL(members_find(&members, "a"));
    CU_ASSERT_PTR_NULL(members_find(&members, "z"));
    snprintf(name, sizeof name, "%.15s", members_at(&members, MEMBERS_MAX - 1)->name);
    set(name, muster_STATE_ABSENT, 77); /* a line that is there can change */
    CU_ASSERT_EQUAL(members_find(&members, name)->pid, 77);
    CU_ASSERT_EQUAL(members.count, MEMBERS_MAX);
}

/* Who comes takes the place of who is gone longest. */
static void test_limit_the_absent_make_way(void)
{
    char name[16];
    for (unsigned i = 0; i < MEMBERS_MAX; i++) {
        snprintf(name, sizeof name, "n%u", i);
        set(name, muster_STATE_RUNNING, i);
    }
    set("n70", muster_STATE_ABSENT, 1);
    set("n7", muster_STATE_ABSENT, 1);
    set("n70", muster_STATE_ABSENT, 2); /* still */
    set("n500", muster_STATE_ABSENT, 1);
    set("n500", muster_STATE_RUNNING, 1); /* it is back */
    set("absent", muster_STATE_ABSENT, 1);
    CU_ASSERT_PTR_NULL(members_find(&members, "absent"));
    set("new", muster_STATE_RUNNING, 1);
    CU_ASSERT_PTR_NOT_NULL(members_find(&members, "new"));
    CU_ASSERT_PTR_NULL(members_find(&members, "n70"));
    CU_ASSERT_PTR_NOT_NULL(members_find(&members, "n7"));
    set("newer", muster_STATE_RUNNING, 1);
    CU_ASSERT_PTR_NULL(members_find(&members, "n7"));
    set("newest", muster_STATE_RUNNING, 1);
    CU_ASSERT_PTR_NULL(members_find(&members, "newest"));
    CU_ASSERT_EQUAL(members.count, MEMBERS_MAX);
    CU_ASSERT_PTR_NOT_NULL(members_find(&members, "n500"));
    CU_ASSERT_PTR_NULL(members_at(&members, MEMBERS_MAX));
}

static void test_limit_fields_are_cut(void)
{
    static char text[4 * MU_FIELD_MAX];
    memset(text, 'h', sizeof text - 1);
    muster_Member line = {.name = words("red"), .broker = text, .host = text, .process = text};
    members_set(&members, &line);
    const struct mu_member *red = members_find(&members, "red");
    CU_ASSERT_PTR_NOT_NULL_FATAL(red);
    CU_ASSERT_EQUAL(strlen(red->broker), MU_NAME_MAX);
    CU_ASSERT_EQUAL(strlen(red->host), MU_FIELD_MAX);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a line is copied whole", test_a_line_is_copied_whole},
        {"order and update", test_order_and_update},
        {"clear", test_clear},
        {"limit: lines", test_limit_lines},
        {"limit: the absent make way", test_limit_the_absent_make_way},
        {"limit: fields are cut", test_limit_fields_are_cut},
        CU_TEST_INFO_NULL,
    };
    CU_SuiteInfo suites[] = {{"runtime/members", NULL, NULL, set_up, NULL, tests},
                             CU_SUITE_INFO_NULL};
    return suites_run(suites);
}
