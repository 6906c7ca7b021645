// What is wrong with a part of a form that has no text field of its own.
import type { FieldProblem } from '../fields/field_problem.js';

export function FieldAlert({ problem, isAbout }: { problem: FieldProblem | null; isAbout(field: string): boolean }) {
  if (problem === null || !isAbout(problem.field)) return null;
  return (
    <p class="problem" role="alert">
      {problem.text}
    </p>
  );
}
