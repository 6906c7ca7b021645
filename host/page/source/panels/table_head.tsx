// The head of a table whose columns have a title each; `children`: the cells of columns without one.
import type { ComponentChildren } from 'preact';

export function TableHead({ titles, children }: { titles: readonly string[]; children?: ComponentChildren }) {
  return (
    <thead>
      <tr>
        {titles.map((title) => (
          <th scope="col" key={title}>
            {title}
          </th>
        ))}
        {children}
      </tr>
    </thead>
  );
}
