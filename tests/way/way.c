/* SPDX-License-Identifier: Apache-2.0 */
/* Sends one plain mail through a broker whose functions are instrumented, and prints each entry
 * (+) and exit (-) of a function of src/broker, as an offset in this program, and three marks:
 * in the box, out of the broker, and acknowledged. */
#include "broker_story.h"

static bool tracing;

/* The address at which this program was loaded. */
extern const char __executable_start; /* NOLINT: the linker's name */

void __cyg_profile_func_enter(void *function, void *caller) __attribute__((no_instrument_function));
void __cyg_profile_func_exit(void *function, void *caller) __attribute__((no_instrument_function));

static void way_print(char what, const void *function)
{
    if (tracing) {
        printf("%c %lx\n", what,
               (unsigned long)((uintptr_t)function - (uintptr_t)&__executable_start));
    }
}

void __cyg_profile_func_enter(void *function, void *caller)
{
    (void)caller;
    way_print('+', function);
}

void __cyg_profile_func_exit(void *function, void *caller)
{
    (void)caller;
    way_print('-', function);
}

static void test_a_plain_mail(void)
{
    struct one_up mail, ack;
    const char *process;
    muster_Delivery d;
    story_begin();
    story_join("red");
    story_join("green");
    muster_Mail hello = letter("red", 1, "green", "hello");
    one_up(&mail, "red", "p-red", &hello, 1, 0);
    one_up(&ack, "green", "p-green", NULL, 0, 1);
    mail.up.broker_incarnation = ack.up.broker_incarnation = story.b->incarnation;
    tracing = true;
    broker_up(story.b, &mail.up, story.now_ns);
    printf("= taken\n");
    CU_ASSERT_TRUE(broker_next(story.b, &process, &d) && d.parcels._length == 1);
    broker_delivered(story.b, story.now_ns);
    printf("= delivered\n");
    broker_up(story.b, &ack.up, story.now_ns);
    printf("= acknowledged\n");
    tracing = false;
    CU_ASSERT_EQUAL(story_status().delivered, 1);
}

int main(void)
{
    CU_TestInfo tests[] = {{"a plain mail", test_a_plain_mail}, CU_TEST_INFO_NULL};
    return suite_run("way", tests);
}
