/* SPDX-License-Identifier: Apache-2.0 */
/* Types as text: what recordings say of our topics, and of types that cannot be said. */
#include "bus/bus.h"
#include "bus/raw/raw.h"
#include "suite.h"
#include "wire.h"

static char name_bytes[256], text_bytes[16384];
static struct mu_text name, text;

static mu_result write_of(const dds_topic_descriptor_t *d)
{
    mu_text_init(&name, name_bytes, sizeof name_bytes);
    mu_text_init(&text, text_bytes, sizeof text_bytes);
    return schema_write(d, &name, &text);
}

static void test_a_struct(void)
{
    CU_ASSERT_EQUAL(write_of(&muster_BrokerEvent_desc), MU_OK);
    READS(name.at, "muster/msg/BrokerEvent");
    READS(text.at, "string broker\nstring kind\nstring agent\nstring sender\nuint64 count\n"
                   "uint64 wall_ns\n");
}

static void test_lists_and_nested(void)
{
    CU_ASSERT_EQUAL(write_of(&muster_PartStatus_desc), MU_OK);
    READS(text.at, "string broker\nstring part\nmuster/Counter[] counters\n"
                   "==========================================================================="
                   "=====\nMSG: muster/Counter\nstring name\nuint64 value\n");
    CU_ASSERT_EQUAL(write_of(&muster_Sense_desc), MU_OK);
    CU_ASSERT_PTR_NOT_NULL(strstr(text.at, "\nfloat32[] sonar_m\n"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text.at, "\nbool stalled\n"));
    CU_ASSERT_PTR_NOT_NULL(strstr(text.at, "\nMSG: muster/Blob\nuint32 rgb\nfloat64 "));
}

static void test_an_enumeration(void)
{
    CU_ASSERT_EQUAL(write_of(&muster_RunStatus_desc), MU_OK);
    READS(name.at, "muster/msg/RunStatus");
    static const char begins[] =
        "string simulator\nuint32 RUN_WAITING=0\nuint32 RUN_READY=1\nuint32 RUN_RUNNING=2\n"
        "uint32 RUN_DONE=3\nuint32 RUN_FAULT=4\nuint32 state\nint64 step\n";
    CU_ASSERT_EQUAL(strncmp(text.at, begins, strlen(begins)), 0);
}

static void test_every_topic_can_be_said(void)
{
    for (int t = 0; t < BUS_TOPICS; t++) {
        mu_text_init(&name, name_bytes, sizeof name_bytes);
        mu_text_init(&text, text_bytes, sizeof text_bytes);
        CU_ASSERT_EQUAL(bus_schema((enum bus_topic)t, &name, &text), MU_OK);
        CU_ASSERT_EQUAL(strncmp(name.at, "muster/msg/", 11), 0);
        CU_ASSERT(text.len > 20);
    }
}

static void test_what_an_older_recording_says(void)
{
    CU_ASSERT_EQUAL(write_of(&muster_PartStatus_desc), MU_OK);
    CU_ASSERT(bus_schema_is(BUS_PART_STATUS, text.at, text.len));
    CU_ASSERT(bus_schema_is(BUS_PART_STATUS, "", 0)); /* it does not say */
    CU_ASSERT_FALSE(bus_schema_is(BUS_PART_STATUS, text.at, text.len - 1));
    CU_ASSERT_FALSE(bus_schema_is(BUS_BROKER_EVENT, text.at, text.len));
    text.at[3] ^= 1;
    CU_ASSERT_FALSE(bus_schema_is(BUS_PART_STATUS, text.at, text.len));
}

static void test_a_type_that_is_silent(void)
{
    dds_topic_descriptor_t silent = {.m_typename = "muster::Page", .m_flagset = 0};
    CU_ASSERT_EQUAL(write_of(&silent), MU_ABSENT);
    READS(text.at, "");
}

static void test_limit_room(void)
{
    mu_text_init(&name, name_bytes, sizeof name_bytes);
    mu_text_init(&text, text_bytes, 64);
    CU_ASSERT_EQUAL(bus_schema(BUS_RUN_STATUS, &name, &text), MU_FULL);
}

int main(void)
{
    CU_TestInfo tests[] = {
        {"a struct", test_a_struct},
        {"lists and nested types", test_lists_and_nested},
        {"an enumeration", test_an_enumeration},
        {"every topic can be said", test_every_topic_can_be_said},
        {"what an older recording says", test_what_an_older_recording_says},
        {"a type that is silent", test_a_type_that_is_silent},
        {"limit: room", test_limit_room},
        CU_TEST_INFO_NULL,
    };
    return suite_run("bus/schema", tests);
}
