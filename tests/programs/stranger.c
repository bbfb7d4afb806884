/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A program of somebody else, with types of its own: writes animals of three cages and a feeding
 * for each, N of them, once somebody reads both. stranger DOMAIN N
 */
#include "stranger.h"

#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>

static dds_entity_t writer_open(dds_entity_t participant, const dds_topic_descriptor_t *type,
                                const char *name)
{
    dds_qos_t *qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(5));
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    dds_entity_t topic = dds_create_topic(participant, type, name, NULL, NULL);
    dds_entity_t writer = dds_create_writer(participant, topic, qos, NULL);
    dds_delete_qos(qos);
    return writer;
}

static void matched_await(dds_entity_t writer)
{
    dds_publication_matched_status_t status = {0};
    while (dds_get_publication_matched_status(writer, &status) == 0 && status.current_count == 0) {
        dds_sleepfor(DDS_MSECS(5));
    }
}

static bool animal_write(dds_entity_t writer, int i)
{
    static char words[][8] = {"left", "right", "tail", "nose", "lion"};
    zoo_Leg legs[4] = {
        {words[0], 0.5f}, {words[1], 0.25f}, {words[2], 1.5f}, {words[3], 0.125f}};
    double weights_kg[] = {i * 0.5, i + 0.25};
    zoo_Animal a = {.cage = i % 3,
                    .number = 1000000000000u + (uint64_t)i,
                    .name = words[4],
                    .tag = "zoo",
                    .mood = (zoo_Mood)(i % 3),
                    .awake = i % 2 == 1,
                    .color = {1, 2, (uint8_t)i}};
    a.legs._buffer = legs;
    a.legs._length = a.legs._maximum = (uint32_t)i % 5;
    a.weights_kg._buffer = weights_kg;
    a.weights_kg._length = a.weights_kg._maximum = (uint32_t)i % 3;
    return dds_write(writer, &a) == DDS_RETCODE_OK;
}

static bool feeding_write(dds_entity_t writer, int i)
{
    char keeper[] = "ann";
    zoo_Feeding f = {.keeper = keeper, .meal = {._d = 2, ._u = {.meat_kg = i}}};
    return dds_write(writer, &f) == DDS_RETCODE_OK;
}

int main(int argc, char **argv)
{
    int domain = argc == 3 ? (int)strtol(argv[1], NULL, 10) : -1;
    int count = argc == 3 ? (int)strtol(argv[2], NULL, 10) : 0;
    dds_entity_t participant = dds_create_participant((dds_domainid_t)domain, NULL, NULL);
    if (domain < 0 || participant < 0) {
        return 4;
    }
    dds_entity_t animals = writer_open(participant, &zoo_Animal_desc, "Animals");
    dds_entity_t feedings = writer_open(participant, &zoo_Feeding_desc, "Feedings");
    matched_await(animals);
    matched_await(feedings);
    bool good = true;
    for (int i = 0; i < count; i++) {
        good = animal_write(animals, i) && feeding_write(feedings, i) && good;
    }
    good = dds_wait_for_acks(animals, DDS_SECS(5)) == DDS_RETCODE_OK && good;
    good = dds_wait_for_acks(feedings, DDS_SECS(5)) == DDS_RETCODE_OK && good;
    printf("%s\n", good ? "done" : "failed");
    dds_delete(participant);
    return good ? 0 : 1;
}
