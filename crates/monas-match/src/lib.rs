//! A match: teams, field, referee and Talws from one file
