/**
 * Shows a value in a field, as the attribute `value` does, but keeps what is typed there: the result
 * of an earlier edit may arrive while the next one is typed.
 */
export function fieldValue(field: HTMLInputElement | HTMLTextAreaElement, value: string): { update: (value: string) => void } {
  let shown = value;
  let sent: string | null = null;
  field.value = value;
  field.addEventListener('change', () => (sent = field.value));
  return {
    update(next: string): void {
      if (field.value === shown || field.value === sent || document.activeElement !== field) {
        field.value = next;
      }
      shown = next;
    },
  };
}
