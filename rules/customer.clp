; SPDX-License-Identifier: Apache-2.0
;
; Has jobs done by whoever has the least to do: it knows the address least-busy:1, and no worker.
; least_busy.clp is the resolver of that address.

(defglobal
  ?*jobs* = (create$ 5000 -4500  0 4800  -5500 4500  5500 5000  0 -4500
                     -5500 0  5500 0  -2000 4800)  ; x y of each, in mm
  ?*first* = 2          ; s: the first two jobs
  ?*pause* = 8)         ; s until the next two

(deffacts beginning
  (goal stay)
  (asked 0)
  (done 0))

(deffunction ask-for (?n)
  (speak request least-busy:1
         (create$ go ?n (nth$ (- (* 2 ?n) 1) ?*jobs*) (nth$ (* 2 ?n) ?*jobs*))
         conversation (sym-cat job- ?n)))

; Two at a time, in one step: the second one goes to another worker.
(defrule ask
  (declare (salience 10))
  ?asked <- (asked ?n)
  (time ?time)
  (test (< (* 2 ?n) (length$ ?*jobs*)))
  (test (>= ?time (+ ?*first* (* ?*pause* (/ ?n 2)))))
  =>
  (retract ?asked)
  (assert (asked (+ ?n 2)))
  (ask-for (+ ?n 1))
  (ask-for (+ ?n 2)))

(defrule hear-done
  (declare (salience 10))
  ?mail <- (mail (performative inform) (from ?who) (content done ?n))
  ?done <- (done ?count)
  =>
  (retract ?mail ?done)
  (assert (done (+ ?count 1)))
  (printout t "job " ?n " is done by " ?who crlf)
  (if (= (* 2 (+ ?count 1)) (length$ ?*jobs*)) then
    (broadcast all-done)))

; The resolver's absence, or nobody who works.
(defrule not-delivered
  (declare (salience 10))
  ?event <- (event refused send ?to ?why)
  =>
  (retract ?event)
  (printout t "nobody for " ?to ": " ?why crlf))
