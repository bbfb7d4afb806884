; SPDX-License-Identifier: Apache-2.0
;
; Does jobs one after the other, in the order of their numbers: drives to a place, and says so to
; the one that asked and to the dispatcher.  least_busy.clp is the dispatcher.

(defglobal
  ?*dispatcher* = dispatcher
  ?*there* = 300)       ; mm: the job is done

(deffacts beginning
  (goal stay))

(defrule hear-roll-call
  (declare (salience 10))
  ?mail <- (mail (content roll-call))
  =>
  (retract ?mail)
  (reply ?mail load (length$ (findall (job $?)))))

(defrule hear-job
  (declare (salience 10))
  ?mail <- (mail (performative request) (from ?from) (content go ?n ?x ?y))
  =>
  (retract ?mail)
  (assert (job ?n ?x ?y ?from)))

(defrule begin-job
  (declare (salience 9))
  (job ?n ?x ?y ?)
  (not (job ?less&:(< ?less ?n) $?))
  (not (working $?))
  =>
  (assert (working ?n))
  (goto ?x ?y))

(defrule finish-job
  (declare (salience 9))
  ?working <- (working ?n)
  ?job <- (job ?n ?x ?y ?from)
  (position ? ?my-x ?my-y $?)
  (test (< (distance ?my-x ?my-y ?x ?y) ?*there*))
  =>
  (retract ?working ?job)
  (speak inform ?from (create$ done ?n))
  (tell ?*dispatcher* done)
  (stay))
