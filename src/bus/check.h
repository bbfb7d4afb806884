/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file check.h
 * The border: what a sample from the network must be before a program sees it.
 *
 * Strings are set and not too long, names are names, counts leave room to count on, percepts are
 * finite, lists are not longer than limits.h allows.  Whether a mail makes sense is the broker's
 * business.
 *
 * @return each: whether the sample keeps the rules
 */
#ifndef MUSTER_BUS_CHECK_H
#define MUSTER_BUS_CHECK_H

#include <stdbool.h>

bool check_registration(const void *sample);
bool check_up(const void *sample);
bool check_sense(const void *sample);
bool check_delivery(const void *sample);
bool check_roster(const void *sample);
bool check_run_command(const void *sample);
bool check_run_answer(const void *sample);
bool check_run_status(const void *sample);
bool check_page(const void *sample);
bool check_broker_status(const void *sample);
bool check_part_status(const void *sample);
bool check_broker_event(const void *sample);
bool check_beacon(const void *sample);
bool check_scene(const void *sample);
bool check_frame(const void *sample);

#endif
