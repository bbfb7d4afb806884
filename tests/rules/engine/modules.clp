; SPDX-License-Identifier: Apache-2.0
; Scripts that CLIPS runs as a program and inside a robot: tests/rules/engine/run.

;;; focus
(defmodule A)
(defmodule B)
(defrule A::r => (printout t A crlf))
(defrule B::r => (printout t B crlf))
(defrule MAIN::m => (printout t M crlf) (focus A B))

;;; auto focus
(defmodule A)
(defrule A::r (declare (auto-focus TRUE)) => (printout t A crlf))
(defrule MAIN::m => (printout t M crlf))

;;; imported
(defmodule A (export deftemplate x))
(deftemplate A::x (slot a))
(deffacts A::f (x (a 1)))
(defmodule B (import A deftemplate x))
(defrule B::r (x (a ?a)) => (printout t got ?a crlf))
(defrule MAIN::m => (focus B))

;;; current
(defmodule A)
(defrule MAIN::m => (printout t (get-focus) (get-current-module) (get-defmodule-list) crlf))

;;; return from a focus
(defmodule A)
(defrule A::r1 (declare (salience 1)) => (printout t one crlf) (return))
(defrule A::r2 => (printout t two crlf))
(defrule MAIN::m => (focus A) (printout t start crlf))
