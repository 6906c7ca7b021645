"""The peripherals of the STM32F405 that QEMU lacks, as far as the program of a module uses them; written from the reference manual RM0090
alone. A word that is not named here keeps what was written. Times are in microseconds."""

BLOCKS = {  # first address, number of words (RM0090, section 2.3)
    "TIM2": (0x40000000, 21), "TIM3": (0x40000400, 20), "TIM5": (0x40000C00, 21), "IWDG": (0x40003000, 4), "USART2": (0x40004400, 7),
    "CAN1": (0x40006400, 200), "PWR": (0x40007000, 2), "ADC1": (0x40012000, 20), "ADC": (0x40012300, 3), "SYSCFG": (0x40013800, 9),
    "EXTI": (0x40013C00, 6), "GPIOA": (0x40020000, 10), "GPIOB": (0x40020400, 10), "GPIOC": (0x40020800, 10), "RCC": (0x40023800, 34),
    "FLASH": (0x40023C00, 6), "DMA1": (0x40026000, 52), "DMA2": (0x40026400, 52)}

IRQ_CAN1_TX, IRQ_CAN1_RX0, IRQ_USART2, IRQ_TIM5 = 19, 20, 38, 50  # table 62

RESET_VALUES = {
    0x40023800: 0x83, 0x40023804: 0x24003010, 0x40023874: 0x0E000000,  # RCC: CR, PLLCFGR, CSR: the power was switched on
    0x40023C10: 0x80000000, 0x40023C14: 0x0FFFAAED & ~0xC | 0x0,       # FLASH: CR, OPTCR with BOR_LEV 0, level 3
    0x40020000: 0xA8000000, 0x40020400: 0x00000280,                    # MODER of GPIOA and GPIOB
    0x40007004: 0x4000,                                                # PWR_CSR: the regulator is ready
    0x40006400: 0x00010002, 0x40006600: 0x2A1C0E01}                    # CAN1: MCR, FMR


class Can:
    """bxCAN (section 32.9), with filters of 16 bits into FIFO 0."""

    def __init__(self, words):
        self.words = words
        self.received = []
        self.mailboxes = [None] * 3
        self.done = 0  # RQCP and TXOK

    def read(self, offset):
        if offset == 0x004:  # MSR: INAK follows INRQ, and SLAK follows SLEEP
            return self.words[0x40006400] & 3 | 0xC00
        if offset == 0x008:  # TSR: TME of the empty mailboxes
            return self.done | sum(1 << 26 + i for i, frame in enumerate(self.mailboxes) if frame is None)
        if offset == 0x00C:  # RF0R
            return len(self.received)
        if offset == 0x018:  # ESR
            return 0
        if 0x1B0 <= offset < 0x1C0 and self.received:
            identifier, data = self.received[0]
            low, high = (int.from_bytes(data.ljust(8, b"\0")[i:i + 4], "little") for i in (0, 4))
            return {0x1B0: identifier << 21, 0x1B4: len(data), 0x1B8: low, 0x1BC: high}[offset]
        return None

    def write(self, offset, value):
        if offset == 0x008:
            for mailbox in range(3):
                if value >> 8 * mailbox & 1:  # RQCP is cleared by 1, and TXOK with it
                    self.done &= ~(3 << 8 * mailbox)
        elif offset == 0x00C and value & 0x20 and self.received:  # RFOM
            self.received.pop(0)
        elif 0x180 <= offset < 0x1B0 and offset % 16 == 0 and value & 1:  # TXRQ in TIR
            mailbox = (offset - 0x180) // 16
            length = self.words[0x40006400 + offset + 4] & 15
            data = b"".join(self.words.get(0x40006400 + offset + at, 0).to_bytes(4, "little") for at in (8, 12))
            self.mailboxes[mailbox] = (value >> 21, data[:length])

    def accepts(self, identifier):
        """Section 32.7.4: lists and masks of 16 bits; data frames have RTR and IDE 0."""
        bank_word = self.words.get
        for bank in range(28):
            if not bank_word(0x4000661C, 0) >> bank & 1:  # FA1R
                continue
            halves = []
            for number in range(2):
                word = bank_word(0x40006640 + 8 * bank + 4 * number, 0)
                halves += [word & 0xFFFF, word >> 16]
            frame = identifier << 5
            if bank_word(0x40006604, 0) >> bank & 1:  # FM1R: a list
                if frame in halves:
                    return True
            elif any((frame ^ halves[i]) & halves[i + 1] == 0 for i in (0, 2)):
                return True
        return False

    def pending(self):
        """The frames in the mailboxes, by identifier."""
        return {frame[0]: frame for frame in self.mailboxes if frame is not None}

    def complete(self, identifier):
        """The frame with this identifier has been sent."""
        mailbox = next(i for i, frame in enumerate(self.mailboxes) if frame is not None and frame[0] == identifier)
        frame = self.mailboxes[mailbox]
        self.mailboxes[mailbox] = None
        self.done |= 3 << 8 * mailbox
        return frame


class Peripherals:
    """All words of BLOCKS. contacts: what the four touch switches at PB12 to PB15 read; 1: open."""

    def __init__(self):
        self.words = {first + 4 * i: 0 for first, count in BLOCKS.values() for i in range(count)}
        self.words.update(RESET_VALUES)
        self.can = Can(self.words)
        self.now = 0
        self.timer_5_starts = None
        self.contacts = 15
        self.console = ""

    def reset(self):
        """A reset of the chip by software: time, switches and what the console has printed stay. RCC_CSR keeps its flags, and has SFTRSTF
        and PINRSTF (section 7.3.21)."""
        csr = 0x40023874
        flags = self.words[csr] | 0x14000000
        self.words.update({address: 0 for address in self.words})
        self.words.update(RESET_VALUES)
        self.words[csr] = flags
        self.can = Can(self.words)
        self.timer_5_starts = None

    def addresses(self):
        return self.words.keys()

    def read(self, address):
        word = self.words.get
        if 0x40006400 <= address < 0x40006800:
            value = self.can.read(address - 0x40006400)
            return word(address, 0) if value is None else value
        if address == 0x40023800:  # RCC_CR: each oscillator is ready as soon as it is on (section 7.3.1)
            return sum(word(address) & 1 << bit | (word(address) >> bit & 1) << bit + 1 for bit in (0, 16, 24)) | word(address) & 0xC0000
        if address == 0x40023808:  # RCC_CFGR: SWS follows SW
            return word(address) & ~0xC | (word(address) & 3) << 2
        if address == 0x40000C24:  # CNT of TIM5, with 1 MHz
            return self.timer_5() & 0xFFFFFFFF
        if address == 0x40000024:  # CNT of TIM2: the time in the servo's period
            return self.now % (word(0x4000002C) + 1)
        if address == 0x40004400:  # SR of USART2: TC and TXE
            return 0xC0
        if address in (0x40020010, 0x40020410, 0x40020810):  # IDR of GPIOA, GPIOB and GPIOC: nothing drives pins with a pull-up but the contacts
            pulls = word(address - 4)
            pulled_up = sum(1 << pin for pin in range(16) if pulls >> 2 * pin & 3 == 1)
            return pulled_up & ~((15 & ~self.contacts) << 12) if address == 0x40020410 else pulled_up
        if address == 0x40012000:  # SR of ADC1: JEOC, STRT
            return 0x14
        if address in (0x4001203C, 0x40012040):  # JDR1: middle of the potentiometer, JDR2: about 25 degrees Celsius
            return 2048 if address == 0x4001203C else 940
        if address == 0x40026414:  # NDTR of stream 0 of DMA2: a sample each 100 us
            size = word(address)
            return size - self.now // 100 % size if size else 0
        return word(address, 0)

    def write(self, address, value):
        if 0x40006400 <= address < 0x40006800:
            self.words[address] = value
            self.can.write(address - 0x40006400, value)
        elif address == 0x40004404:  # DR of USART2
            self.console += chr(value & 0xFF)
        elif address in (0x40003000, 0x40000C10, 0x40012000, 0x40013C14):  # IWDG_KR; flags that a write clears
            pass
        else:
            self.words[address] = value
        if address == 0x40000C00 and value & 1:
            self.timer_5_starts = self.now

    def timer_5(self):
        return 0 if self.timer_5_starts is None else self.now - self.timer_5_starts

    def alarm(self):
        """Time at which TIM5 reaches CCR1, if its interrupt is enabled."""
        if self.timer_5_starts is None or not self.words[0x40000C0C] & 2:
            return None
        distance = self.words[0x40000C34] - self.timer_5() & 0xFFFFFFFF
        return self.now + distance if 0 < distance < 1 << 31 else None

    def interrupts(self):
        """Requests that stand because of a level: characters that may be sent, frames that wait in FIFO 0, mailboxes that are done."""
        found = []
        if self.words[0x4000440C] & 0x80:  # TXEIE
            found.append(IRQ_USART2)
        enabled = self.words[0x40006414]
        if enabled & 1 and self.can.done:
            found.append(IRQ_CAN1_TX)
        if enabled & 2 and self.can.received:
            found.append(IRQ_CAN1_RX0)
        return found
