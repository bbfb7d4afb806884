/* SPDX-License-Identifier: Apache-2.0 */
/* Who may be named in a multicast, and when one is worth waking those whom it does not name. */
#include "broker_story.h"

enum { CROWD = 6 };

static const char *const crew[CROWD] = {"a", "b", "c", "d", "e", "f"};

static uint64_t seq;

/* red says something to all.  @return how many boxes the multicasts have that go out then */
static uint32_t boxes_told(void)
{
    const char *process;
    muster_Delivery d;
    uint32_t boxes = 0;
    story_mail(letter("red", ++seq, "all", "hi"));
    while (broker_next(story.b, &process, &d)) {
        boxes += d.seats._length;
        broker_delivered(story.b, story.now_ns);
    }
    return boxes;
}

static void acknowledge_all(uint64_t number)
{
    for (int i = 0; i < CROWD; i++) {
        story_ack(crew[i], number);
    }
    (void)story_collect();
}

/* Each lives in a process of its own, which hears multicasts, and has acknowledged one mail. */
static void crowd_begin(void)
{
    char process[MU_PROCESS_MAX + 1];
    seq = 0;
    story_begin();
    story_join("red");
    for (int i = 0; i < CROWD; i++) {
        story_join(crew[i]);
        snprintf(process, sizeof process, "p-%s", crew[i]);
        broker_hears(story.b, process);
    }
    (void)story_collect();
    CU_ASSERT_EQUAL(boxes_told(), 0); /* nobody knows its seat yet */
    acknowledge_all(1);
}

/* Until it has taken a mail it takes any number for the next: what overtakes a multicast would take
 * its place. */
static void test_another_agent_of_a_process_has_its_first_mail_alone(void)
{
    crowd_begin();
    CU_ASSERT_EQUAL(boxes_told(), CROWD);
    story_register("late", "p-a");
    (void)story_collect();
    CU_ASSERT_EQUAL(boxes_told(), CROWD);
    acknowledge_all(3);
    CU_ASSERT_EQUAL(boxes_told(), CROWD);
    struct one_up u;
    one_up(&u, "late", "p-a", NULL, 0, 1);
    story_hear(&u.up);
    (void)story_collect();
    CU_ASSERT_EQUAL(boxes_told(), CROWD + 1);
}

static void test_processes_of_other_brokers_are_not_woken_in_vain(void)
{
    crowd_begin();
    story.b->multicast.readers = 2 * CROWD;
    CU_ASSERT_EQUAL(boxes_told(), CROWD);
    story.b->multicast.readers = 2 * CROWD + 1;
    CU_ASSERT_EQUAL(boxes_told(), 0);
    story.b->multicast.readers = CROWD;
    CU_ASSERT_EQUAL(boxes_told(), CROWD);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"another agent of a process has its first mail alone",
         test_another_agent_of_a_process_has_its_first_mail_alone},
        {"processes of other brokers are not woken in vain",
         test_processes_of_other_brokers_are_not_woken_in_vain},
        CU_TEST_INFO_NULL,
    };
    return suite_run("broker/hearers", tests);
}
