; SPDX-License-Identifier: Apache-2.0
;
; A contractor of a contract net: proposes to do a job for the way that it has to go, does it when
; its proposal is accepted, and says so.  manager.clp is the other side.

(defglobal
  ?*there* = 300          ; mm: the job is done
  ?*job-time* = 90)       ; s after which it gives up

(deffacts beginning
  (goal stay))

(defrule enter
  (event on-run)
  =>
  (group-join contractors))

; Who works has no time for another job.
(defrule refuse
  (declare (salience 11))
  ?mail <- (mail (performative cfp) (from ?boss) (conversation ?job))
  (working $?)
  =>
  (retract ?mail)
  (speak refuse ?boss (create$ busy) conversation ?job))

(defrule propose
  (declare (salience 10))
  ?mail <- (mail (performative cfp) (from ?boss) (conversation ?job) (content task ?n ?x ?y))
  (position ? ?my-x ?my-y $?)
  (not (working $?))
  =>
  (retract ?mail)
  (speak propose ?boss (create$ cost (distance ?my-x ?my-y ?x ?y)) conversation ?job))

; More urgent than to answer the next call, which may come with it.
(defrule work
  (declare (salience 12))
  ?mail <- (mail (performative accept-proposal) (from ?boss) (conversation ?job)
                 (content do ?n ?x ?y))
  (position ?time $?)
  =>
  (retract ?mail)
  (assert (working ?job ?boss ?n ?x ?y ?time))
  (goto ?x ?y))

(defrule lose
  (declare (salience 10))
  ?mail <- (mail (performative reject-proposal))
  =>
  (retract ?mail))

(defrule finish
  (declare (salience 9))
  ?work <- (working ?job ?boss ?n ?x ?y ?)
  (position ? ?my-x ?my-y $?)
  (test (< (distance ?my-x ?my-y ?x ?y) ?*there*))
  =>
  (retract ?work)
  (speak inform ?boss (create$ done ?n) conversation ?job)
  (stay))

(defrule give-up
  (declare (salience 9))
  ?work <- (working ?job ?boss ?n ? ? ?since)
  (position ?time $?)
  (test (> (- ?time ?since) ?*job-time*))
  =>
  (retract ?work)
  (speak failure ?boss (create$ gave-up ?n) conversation ?job)
  (stay))
