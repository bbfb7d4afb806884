/* SPDX-License-Identifier: Apache-2.0 */
/* Two Frames are equal until any value of one is another. */
#include "story/story.h"
#include "suite.h"

#include <CUnit/Basic.h>
#include <stdio.h>
#include <string.h>

#define W(s) ((char *)(uintptr_t)(s))

/* A Frame with one of everything. */
struct sample {
    muster_RobotView robots[2];
    muster_ObjectPlace puck;
    muster_Act acts[2];
    muster_Mail mail, outside;
    muster_RunCommand order;
    muster_Frame frame;
};

static muster_Mail mail_make(const char *src, const char *content)
{
    return (muster_Mail){.src = W(src),
                         .seq = 1,
                         .dst = W("blue"),
                         .performative = W("tell"),
                         .content = W(content)};
}

static void sample_make(struct sample *s)
{
    memset(s, 0, sizeof *s);
    s->robots[0] = (muster_RobotView){.name = W("red"), .goal = W(""), .x_m = 1};
    s->robots[1] = (muster_RobotView){.name = W("blue"), .goal = W(""), .x_m = 2};
    s->puck = (muster_ObjectPlace){.name = W("puck")};
    s->mail = mail_make("red", "near 1.0");
    s->outside = mail_make("operator", "(stop)");
    s->order = (muster_RunCommand){.source = W("operator"), .name = W("red")};
    s->acts[0] =
        (muster_Act){.agent = W("red"), .rules = W("a b"), .goal = W(""), .diary = W("S\n")};
    s->acts[1] = (muster_Act){.agent = W("blue"), .rules = W(""), .goal = W(""), .diary = W("")};
    s->acts[0].mails = (dds_sequence_muster_Mail){._length = 1, ._buffer = &s->mail};
    s->frame = (muster_Frame){.step = 7, .digest = 9};
    s->frame.robots._buffer = s->robots;
    s->frame.robots._length = 2;
    s->frame.objects._buffer = &s->puck;
    s->frame.objects._length = 1;
    s->frame.acts._buffer = s->acts;
    s->frame.acts._length = 2;
    s->frame.outside._buffer = &s->outside;
    s->frame.outside._length = 1;
    s->frame.orders._buffer = &s->order;
    s->frame.orders._length = 1;
}

static struct sample one, other;

static void begin(void)
{
    sample_make(&one);
    sample_make(&other);
}

/* The difference as one line; "" when there is none. */
static const char *difference(void)
{
    static char text[1024];
    struct difference d;
    text[0] = '\0';
    if (differ_frames(&one.frame, &other.frame, &d)) {
        snprintf(text, sizeof text, "%lld %s %s: %s, %s", (long long)d.step, d.who, d.what, d.one,
                 d.other);
    }
    return text;
}

static void test_equal(void)
{
    begin();
    CU_ASSERT_STRING_EQUAL(difference(), "");
    muster_Act red = other.acts[0];
    other.acts[0] = other.acts[1]; /* who answered first does not matter */
    other.acts[1] = red;
    CU_ASSERT_STRING_EQUAL(difference(), "");
    other.acts[1].diary = W(""); /* one of them was recorded without */
    CU_ASSERT_STRING_EQUAL(difference(), "");
    other.frame.digest = 0; /* free running has none */
    CU_ASSERT_STRING_EQUAL(difference(), "");
}

static void test_each_value(void)
{
    const struct {
        void *at;
        size_t bytes;
        const char *wanted;
    } cases[] = {
        {&other.robots[1].x_m, 8, "7 blue x_m: 2, "},
        {&other.robots[0].y_m, 8, "7 red y_m: 0, "},
        {&other.robots[0].heading_rad, 8, "7 red heading_rad: "},
        {&other.robots[0].forward_m_s, 8, "7 red forward_m_s: "},
        {&other.robots[0].turn_rad_s, 8, "7 red turn_rad_s: "},
        {&other.robots[0].command_forward_m_s, 8, "7 red command_forward_m_s: "},
        {&other.robots[0].command_turn_rad_s, 8, "7 red command_turn_rad_s: "},
        {&other.robots[0].stalled, 1, "7 red stalled: 0, 1"},
        {&other.robots[0].fault, 1, "7 red fault: 0, 1"},
        {&other.puck.x_m, 8, "7 puck x_m: "},
        {&other.puck.y_m, 8, "7 puck y_m: "},
        {&other.puck.heading_rad, 8, "7 puck heading_rad: "},
        {&other.acts[0].state, 1, "7 red act.state: 0, 1"},
        {&other.acts[0].drives, 1, "7 red act.drives: 0, 1"},
        {&other.acts[0].forward_m_s, 8, "7 red act.forward_m_s: "},
        {&other.acts[1].turn_rad_s, 8, "7 blue act.turn_rad_s: "},
        {&other.acts[0].paddles, 1, "7 red act.paddles: 0, 1"},
        {&other.acts[0].lift, 1, "7 red act.lift: 0, 1"},
        {&other.acts[0].firings, 1, "7 red act.firings: 0, 1"},
        {&other.mail.seq, 8, "7 red mail.seq: 1, "},
        {&other.outside.seq, 8, "7 operator mail.seq: 1, "},
        {&other.order.order, 1, "7 operator order: 0, 1"},
        {&other.order.x_m, 8, "7 operator order.x_m: "},
        {&other.order.force_y_n, 8, "7 operator order.force_y_n: "},
        {&other.order.time_s, 8, "7 operator order.time_s: "},
        {&other.order.senses, 1, "7 operator order.senses: 0, 1"},
        {&other.order.on, 1, "7 operator order.on: 0, 1"},
        {&other.frame.digest, 8, "7  digest: 0000000000000009, "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        begin();
        unsigned char *at = cases[i].at;
        at[cases[i].bytes - 1] ^= 1; /* one bit, however small the value */
        const char *got = difference();
        CU_ASSERT_EQUAL(strncmp(got, cases[i].wanted, strlen(cases[i].wanted)), 0);
        if (strncmp(got, cases[i].wanted, strlen(cases[i].wanted)) != 0) {
            fprintf(stderr, "wanted %s\n   got %s\n", cases[i].wanted, got);
        }
    }
}

static void test_each_text(void)
{
    const struct {
        char **at;
        const char *wanted;
    } cases[] = {
        {&other.robots[0].name, "7 red name: red, X"},
        {&other.puck.name, "7 puck name: puck, X"},
        {&other.acts[0].agent, "7 red acts: 1, 0"},
        {&other.acts[0].rules, "7 red act.rules: a b, X"},
        {&other.acts[0].diary, "7 red act.diary: S\n, X"},
        {&other.mail.src, "7 red mail.src: red, X"},
        {&other.mail.dst, "7 red mail.dst: blue, X"},
        {&other.mail.performative, "7 red mail.performative: tell, X"},
        {&other.mail.content, "7 red mail.content: near 1.0, X"},
        {&other.outside.content, "7 operator mail.content: (stop), X"},
        {&other.order.source, "7 operator order.source: operator, X"},
        {&other.order.name, "7 operator order.name: red, X"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        begin();
        *cases[i].at = W("X");
        CU_ASSERT_STRING_EQUAL(difference(), cases[i].wanted);
    }
}

static void test_what_is_missing(void)
{
    begin();
    other.frame.robots._length = 1;
    CU_ASSERT_STRING_EQUAL(difference(), "7  robots: 2, 1");
    begin();
    other.acts[0].mails._length = 0;
    CU_ASSERT_STRING_EQUAL(difference(), "7 red mails: 1, 0");
    begin();
    other.frame.outside._length = 0;
    CU_ASSERT_STRING_EQUAL(difference(), "7  mails: 1, 0");
    begin();
    other.frame.orders._length = 0;
    CU_ASSERT_STRING_EQUAL(difference(), "7  orders: 1, 0");
    begin();
    other.frame.step = 8;
    CU_ASSERT_STRING_EQUAL(difference(), "7  step: 7, 8");
}

/* Long texts are shown where they part. */
static void test_long_texts(void)
{
    static char a[4096], b[4096];
    begin();
    memset(a, 'a', sizeof a - 1);
    memset(b, 'a', sizeof b - 1);
    b[3000] = 'b';
    one.acts[0].diary = a;
    other.acts[0].diary = b;
    const char *got = difference();
    CU_ASSERT_PTR_NOT_NULL(strstr(got, "...aaaaaaaaaaaaaaaaaaaab"));
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"equal", test_equal},           {"each value", test_each_value},
        {"each text", test_each_text},   {"what is missing", test_what_is_missing},
        {"long texts", test_long_texts}, CU_TEST_INFO_NULL,
    };
    return suite_run("story/differ", tests);
}
