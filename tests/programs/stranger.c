/* SPDX-License-Identifier: Apache-2.0 */
/*
 * A program of somebody else, with types of its own: writes animals of three cages and a feeding
 * for each, N of them, once somebody reads both; then the first cage is disposed, filled again and
 * disposed again, and the second one let go of.
 *   stranger DOMAIN N
 *   stranger DOMAIN N read
 * The second reads all that, with as much asked for as the first offers, and prints how many of
 * each are as they were written.
 */
#include "stranger.h"

#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All that readers and writers match by; less of it is asked for than is offered. */
static dds_qos_t *animals_qos(bool reads)
{
    dds_qos_t *qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(5));
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    dds_qset_durability(qos, DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(qos, 0, DDS_HISTORY_KEEP_LAST, 1, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
    dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
    dds_qset_deadline(qos, reads ? DDS_SECS(40) : DDS_SECS(20));
    dds_qset_liveliness(qos, DDS_LIVELINESS_AUTOMATIC, reads ? DDS_SECS(60) : DDS_SECS(30));
    dds_qset_destination_order(qos, DDS_DESTINATIONORDER_BY_SOURCE_TIMESTAMP);
    if (!reads) {
        dds_qset_writer_data_lifecycle(qos, false);
        dds_qset_ownership_strength(qos, 3);
    }
    return qos;
}

static dds_qos_t *feedings_qos(void)
{
    dds_qos_t *qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(5));
    dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, 0);
    return qos;
}

static dds_qos_t *partitions_qos(bool reads)
{
    const char *names[] = {"zoo.north", "zoo.south"};
    dds_qos_t *qos = dds_create_qos();
    dds_qset_partition(qos, reads ? 1 : 2, reads ? names + 1 : names);
    dds_qset_presentation(qos, DDS_PRESENTATION_TOPIC, false, true);
    return qos;
}

static dds_entity_t topic_open(dds_entity_t participant, const dds_topic_descriptor_t *type,
                               const char *name)
{
    return dds_create_topic(participant, type, name, NULL, NULL);
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
    zoo_Leg legs[4] = {{words[0], 0.5f}, {words[1], 0.25f}, {words[2], 1.5f}, {words[3], 0.125f}};
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
    static char keepers[][40] = {"ann", "a keeper with more names than fit"};
    zoo_Feeding f = {.keeper = keepers[i % 2], .meal = {._d = 2, ._u = {.meat_kg = i}}};
    return dds_write(writer, &f) == DDS_RETCODE_OK;
}

static bool cages_end(dds_entity_t animals, int count)
{
    zoo_Animal first = {.cage = 0}, second = {.cage = 1};
    bool good = dds_dispose(animals, &first) == DDS_RETCODE_OK;
    good = animal_write(animals, 3 * count) && good;
    good = dds_dispose(animals, &first) == DDS_RETCODE_OK && good;
    return dds_unregister_instance(animals, &second) == DDS_RETCODE_OK && good;
}

static int zoo_write(dds_entity_t participant, dds_entity_t group, int count)
{
    dds_qos_t *qos = animals_qos(false), *plain = feedings_qos();
    dds_entity_t animals =
        dds_create_writer(group, topic_open(participant, &zoo_Animal_desc, "Animals"), qos, NULL);
    dds_entity_t feedings = dds_create_writer(
        participant, topic_open(participant, &zoo_Feeding_desc, "Feedings"), plain, NULL);
    dds_delete_qos(qos);
    dds_delete_qos(plain);
    matched_await(animals);
    matched_await(feedings);
    bool good = true;
    for (int i = 0; i < count; i++) {
        good = animal_write(animals, i) && feeding_write(feedings, i) && good;
    }
    good = cages_end(animals, count) && good;
    good = dds_wait_for_acks(animals, DDS_SECS(5)) == DDS_RETCODE_OK && good;
    good = dds_wait_for_acks(feedings, DDS_SECS(5)) == DDS_RETCODE_OK && good;
    printf("%s\n", good ? "done" : "failed");
    return good ? 0 : 1;
}

/* --- reading ---------------------------------------------------------------------------------- */

static struct {
    int animals, feedings, disposed, unregistered;
} seen;

static bool animal_is(const zoo_Animal *a)
{
    int i = (int)(a->number - 1000000000000u);
    return a->cage == i % 3 && strcmp(a->name, "lion") == 0 && strcmp(a->tag, "zoo") == 0 &&
           a->mood == (zoo_Mood)(i % 3) && a->awake == (i % 2 == 1) && a->color[2] == (uint8_t)i &&
           a->legs._length == (uint32_t)i % 5 && a->weights_kg._length == (uint32_t)i % 3;
}

static void animals_take(dds_entity_t reader)
{
    void *samples[1] = {NULL};
    dds_sample_info_t info;
    while (dds_take(reader, samples, &info, 1, 1) == 1) {
        seen.animals += info.valid_data && animal_is(samples[0]);
        seen.disposed += info.instance_state == DDS_IST_NOT_ALIVE_DISPOSED;
        seen.unregistered += info.instance_state == DDS_IST_NOT_ALIVE_NO_WRITERS;
        (void)dds_return_loan(reader, samples, 1);
    }
}

static void feedings_take(dds_entity_t reader)
{
    void *samples[1] = {NULL};
    dds_sample_info_t info;
    while (dds_take(reader, samples, &info, 1, 1) == 1) {
        const zoo_Feeding *f = samples[0];
        seen.feedings += info.valid_data && f->keeper[0] == 'a' && f->meal._d == 2;
        (void)dds_return_loan(reader, samples, 1);
    }
}

/* Until all is there, or nothing comes for ten seconds. */
static int zoo_read(dds_entity_t participant, dds_entity_t group, int count)
{
    dds_qos_t *qos = animals_qos(true), *plain = feedings_qos();
    dds_entity_t animals =
        dds_create_reader(group, topic_open(participant, &zoo_Animal_desc, "Animals"), qos, NULL);
    dds_entity_t feedings = dds_create_reader(
        participant, topic_open(participant, &zoo_Feeding_desc, "Feedings"), plain, NULL);
    dds_delete_qos(qos);
    dds_delete_qos(plain);
    printf("ready\n");
    fflush(stdout);
    int before = 0;
    for (int idle_ms = 0; idle_ms < 10000;) {
        animals_take(animals);
        feedings_take(feedings);
        int all = seen.animals + seen.feedings + seen.disposed + seen.unregistered;
        bool whole = seen.animals == count + 1 && seen.feedings == count;
        idle_ms = all > before ? 0 : whole ? idle_ms + 10 : idle_ms + 1;
        before = all;
        dds_sleepfor(DDS_MSECS(1));
    }
    printf("%d animals, %d feedings, disposed: %s, let go of: %s\n", seen.animals, seen.feedings,
           seen.disposed > 0 ? "yes" : "no", seen.unregistered > 0 ? "yes" : "no");
    return 0;
}

int main(int argc, char **argv)
{
    int domain = argc > 2 ? (int)strtol(argv[1], NULL, 10) : -1;
    int count = argc > 2 ? (int)strtol(argv[2], NULL, 10) : 0;
    bool reads = argc > 3 && strcmp(argv[3], "read") == 0;
    dds_entity_t participant = dds_create_participant((dds_domainid_t)domain, NULL, NULL);
    if (domain < 0 || participant < 0) {
        return 4;
    }
    dds_qos_t *partitions = partitions_qos(reads);
    dds_entity_t group = reads ? dds_create_subscriber(participant, partitions, NULL)
                               : dds_create_publisher(participant, partitions, NULL);
    dds_delete_qos(partitions);
    int code = reads ? zoo_read(participant, group, count) : zoo_write(participant, group, count);
    dds_delete(participant);
    return code;
}
