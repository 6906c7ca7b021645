// The theme, light or dark: that of the system, or the one that was chosen here.
import { computed, effect, signal } from '@preact/signals-core';
import { otherTheme, type ThemeChoice } from './theme_choice.js';
import { storeChoice, storedChoice } from './stored_choice.js';

const key = 'proleg.theme';
const order: readonly ThemeChoice[] = ['system', 'light', 'dark'];

const query = window.matchMedia('(prefers-color-scheme: dark)');
const systemIsDark = signal(query.matches);
query.addEventListener('change', () => (systemIsDark.value = query.matches));

const stored = storedChoice(key);

export const themeChoice = signal<ThemeChoice>(order.find((choice) => choice === stored) ?? 'system');

export const isDark = computed(() =>
  themeChoice.value === 'system' ? systemIsDark.value : themeChoice.value === 'dark',
);

effect(() => {
  document.documentElement.dataset['theme'] = isDark.value ? 'dark' : 'light';
});

export function nextTheme(): void {
  const next = otherTheme(isDark.peek(), systemIsDark.peek());
  storeChoice(key, next);
  themeChoice.value = next;
}
