/** Filters of the views; they are kept when another view is shown. */

export interface TopicFilter {
  host: string;
  text: string;
}

export interface LogFilter {
  /** The lowest level that is shown. */
  level: string;
  host: string;
  text: string;
}
